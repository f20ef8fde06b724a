"""Show a red box, for tests that look at its picture: in a browser's page, or in a notebook's cell."""

import mujoco

from tutorial.view.bodies import View
from tutorial.view.scene import Scene

DISTANCE = 4.0  # [m] between the box and a camera that looks along y, level with it

MODEL = """
<mujoco>
  <worldbody>
    <body name="box">
      <freejoint/><geom type="box" size="0.3 0.3 0.3" rgba="0.9 0.05 0.05 1"/>
    </body>
  </worldbody>
</mujoco>
"""


class RedBox:
    """The box, in front of a camera that looks along y at a point in the plane of the box."""

    def __init__(self, x=0, z=0):
        self.model = mujoco.MjModel.from_xml_string(MODEL)
        self.data = mujoco.MjData(self.model)
        self.scene = Scene()
        self.view = View(self.scene)
        self.view.add("box", self.model)
        self.look_at(0, 0)
        self.move(x, z)

    def look_at(self, x, z):
        self.middle = x, z
        self.scene.look_at((x, -DISTANCE, z), (x, 0, z))
        self.view.flush()

    def move(self, x, z):
        self.data.qpos[[0, 2]] = x, z
        mujoco.mj_kinematics(self.model, self.data)
        self.view.update("box", self.data)
        self.view.flush()

    def say(self, *what):
        self.scene.line(*what)
        self.scene.flush()

    @property
    def place(self):
        """Return how far right of the picture's centre, and above it, the box is [m]."""
        return self.data.qpos[[0, 2]] - self.middle
