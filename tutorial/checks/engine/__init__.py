"""The engine of the exercises: it tries an answer, finds out why the answer is wrong, and explains the causes.

An exercise's module imports each name from the engine module that defines it.

- `answer`, `failure`: the learner's code, and its failures. `exceptions`: the most likely causes of exceptions.
- `trial`, `instruments`: one run of an answer, and how the answer uses time and threads in this run.
- `cases`: the data of an exercise: its cases and the known mistakes.
- `twins`, `slips`: the solution with known mistakes, or with small slips.
- `observe`, `diagnose`, `report`: the three steps of a check. `shared_state`: state that the learner's objects share
  by accident. `verdict`: the text that the learner reads.
- `contain`, `child`: the code that starts the process for an answer, and the code that runs in this process.
- `memory_node`, `bodies`, `rig`: an environment for the controller of a simulated body. `publishing`: cases for all
  controllers that publish at a fixed rate.
- `viewer`, `clock`: an environment for the controller of a displayed body. `viewing`: cases for all viewers.
- `interleave`: a thread that another thread interrupts at every instruction. `real_dds`: the last check, on rclpy's
  own node.
"""
