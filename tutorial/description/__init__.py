"""The robot description: a URDF for other programs, made from a MuJoCo model."""
