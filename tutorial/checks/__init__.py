"""Self-checks of the exercises, one file per exercise set, called like the controller that the step builds.

In a notebook::

    from tutorial.checks.tank_controller import drive
    await drive.check(GentleTank)   # says what was right, and for what is wrong the most likely cause
    drive.hint()
    drive.solution()

A further step adds its own file. The answer is run in a process of its own, in a ROS domain of its own, on simulated
time: whatever it does, the learner's own programs go on undisturbed.
"""
