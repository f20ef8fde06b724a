"""Open and close the notebooks' programs ten times in a kernel while messages arrive: nothing may be left."""

import json
import re

import pytest
from kernels import kernel

pytestmark = pytest.mark.nightly

ROUNDS = 10
TROUBLE = re.compile("Traceback|InvalidHandle|ERROR")


PROGRAMS = """
import json, threading
import psutil
from tutorial.notebook import *
from sensor_msgs.msg import JointState, Joy

def flood():  # a node that goes on publishing while the others come and go
    hand = open_node("hand")
    sticks = hand.create_publisher(Joy, "/joy", 1)
    joints = hand.create_publisher(JointState, "/Tank/joint_state", 1)
    hand.create_timer(0.002, lambda: sticks.publish(Joy(axes=[0.0, 0.3])))
    hand.create_timer(0.002, lambda: joints.publish(JointState(name=["TURRET_Y"], position=[0.5])))

def left():
    names = sorted(thread.name for thread in threading.enumerate())
    return {"threads": names, "native": psutil.Process().num_threads(), "files": psutil.Process().num_fds()}

async def go_round():
    flood()
    widgets = joystick(), joint_plot(), node_graph()
    for project, node in (("step1", "simulation"), ("step2", "simulation"), ("step3", "viewer")):
        program = open_program(project, node=node)  # the one of its name is closed, and messages go on arriving
        if node == "simulation":
            program.start()
        await until(lambda: program.received > 20)
        assert program.error is None
    close_all()
    log()
    return left()
"""


@pytest.mark.timeout(300)
def test_reopening_programs_leaves_nothing(domain):
    def answer(expression):
        *said, text = running.run(f"print(json.dumps({expression}))").splitlines()
        assert not TROUBLE.search("".join(said)), said
        return json.loads(text)

    with kernel() as running:
        assert running.run(PROGRAMS) == ""
        before = answer("left()")
        rounds = [answer("await go_round()") for _ in range(ROUNDS)]
    for after in rounds:
        assert after["threads"] == before["threads"]
    for what in ("native", "files"):
        grown = rounds[-1][what] - rounds[0][what]
        assert grown < ROUNDS - 1, f"each round leaves some:{[each[what] for each in rounds]}"
