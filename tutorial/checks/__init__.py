"""Self-checks for the exercises. `README.md` in this folder explains how to add an exercise.

In a notebook::

    from tutorial.checks.tank_controller import drive
    await drive.check(GentleTank)   # shows what is right and what is wrong, with the most likely causes
    drive.hint()
    drive.solution()

Each exercise has a module with the same name. Each step's module, such as `tank_controller`, lists the exercises of the
step's notebook. A check runs the answer in simulated time, and in a separate process and ROS domain, so that the answer
cannot interfere with the learner's programs.

Learners use `exercise`; `catalogue` lists all exercises, and `engine` contains the code that the exercises share.
"""
