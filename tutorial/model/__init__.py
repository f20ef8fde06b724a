"""Information from MuJoCo models: actuators, joint couplings, options, URDF files, and MuJoCo's warnings."""
