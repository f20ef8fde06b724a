"""The engine of the exercises: it tries an answer, finds out why it is wrong, and says so.

An exercise's module imports what it needs from the module here that defines it.

- `answer`, `failure`: what the learner wrote, and what goes wrong in it; `exceptions`: why it probably did.
- `trial`, `instruments`: one attempt at an answer, and what the answer does meanwhile with time and threads.
- `cases`: the data of an exercise: what is tried, and which mistakes are known.
- `twins`, `slips`: the solution with mistakes in it: those of the exercise, and small slips.
- `observe`, `diagnose`, `report`: the three steps of a check. `shared_state`: what objects share that they should not;
  `verdict`: what the learner reads.
- `contain`, `child`: the process in which an answer runs, from outside and from inside.
- `memory_node`, `bodies`, `rig`: what the controller of a simulated body is tried with; `publishing`: what is tried of
  all controllers that publish at a rate.
- `viewer`, `clock`: what the controller of a displayed body is tried with; `viewing`: what is tried of all of them.
- `interleave`, `real_dds`: two threads in every order, and rclpy's own node.
"""
