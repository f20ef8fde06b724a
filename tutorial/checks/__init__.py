"""Self-checks of the exercises. `README.md` in this folder says how to add one.

In a notebook::

    from tutorial.checks.tank_controller import drive
    await drive.check(GentleTank)   # says what is right, and for what is wrong the most likely cause
    drive.hint()
    drive.solution()

Each exercise is a module of its own name; each step's module, such as `tank_controller`, lists the exercises of its
notebook. The answer runs in a process of its own, in a ROS domain of its own, on simulated time, so it cannot disturb
the learner's own programs.

`exercise` is an exercise as the learner meets it, `catalogue` the list of all, and `engine` what all of them share.
"""
