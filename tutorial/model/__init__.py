"""What a MuJoCo model says about itself: actuators, joint couplings, options, its URDF, and MuJoCo's warnings."""
