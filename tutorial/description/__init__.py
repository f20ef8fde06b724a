"""The robot description: what other programs know of a robot, a URDF made from its MuJoCo model."""
