"""The panel of faults: its sliders change the published messages, on any thread."""

import math
import threading

from sensor_msgs.msg import JointState

from tutorial.notebook.desk import until
from tutorial.notebook.widgets.chaos_panel import ChaosPanel
from tutorial.ros.chaos import FAULTS
from tutorial.ros.node_thread import NodeThread

from .pages import on_a_subshell


def move(slider, value):
    on_a_subshell(slider.set_trait, "value", value)


async def test_a_slider_adds_a_fault_and_the_button_removes_all(domain):
    heard = []
    with NodeThread("listener") as thread:
        thread.node.create_subscription(JointState, "/Tank/joint_state", heard.append, 10)
        panel = ChaosPanel()
        assert repr(panel) == "ChaosPanel()"
        assert list(panel.sliders) == list(FAULTS)
        await until(lambda: heard, "a good message")
        assert not any(panel.made.values())
        move(panel.sliders["nan"], 1.0)
        await until(lambda: math.isnan(sum(heard[-1].position)), "a NaN")
        await until(lambda: panel._hits.value.startswith("affected messages: nan "), "the count")
        panel._reset.click()
        assert panel.sliders["nan"].value == 0
        await until(lambda: not math.isnan(sum(heard[-1].position)), "a good message again")
        panel.end()


async def test_ended_it_stops_publishing_and_leaves_no_thread(domain):
    threads = threading.active_count()
    panel = ChaosPanel()
    move(panel.sliders["second"], 1.0)
    await until(lambda: panel.made["second"], "a second publisher")
    panel.end()
    panel.end()
    assert panel.ended
    assert threading.active_count() <= threads
