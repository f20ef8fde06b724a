"""Self-checks of the exercises, one file per exercise set, called like the controller that the step builds.

In a notebook::

    from tutorial.checks.tank_controller import drive
    await drive.check(GentleTank)   # says what was right, and for what is wrong the most likely cause
    drive.hint()
    drive.solution()

A further step adds its own file. The answer is run in a process of its own, in a ROS domain of its own, on simulated
time: whatever it does, the learner's own programs go on undisturbed.

The modules that all exercises share, one at a time:

- `exercise`, `catalogue`: an exercise as the learner meets it, and the list of all.
- `_answer`: whether something was written that can be run.
- `_contain`, `_child`: the process that judges an answer, from outside and from inside.
- `_watch`: which of the learner's methods runs, what it raises, and how it uses time and threads.
- `_verdict`, `_diagnose`: what was found, and how it is said; what most likely led to an exception.
- `_mistakes`: known mistakes, as edits of the solution.
- `_cases`: what an answer is tried in, and which mistake explains what is observed; `_publishing`: what is tried of all
  controllers that publish at a rate.
- `_rig`: what a simulated body's controller is tried on, and any controller's node; `_viewer`: what a displayed
  body's is, and what is tried of all such. `_clock`: its event loop.
- `_interleave`, `_shared`: two threads in every order, and what objects share that should not.
"""
