"""The panel of faults: what its sliders do to what is published, from whatever thread they are moved."""

import asyncio
import math
import threading

import pytest
from sensor_msgs.msg import JointState

from tutorial.notebook.desk import until
from tutorial.notebook.widgets.chaos_panel import ChaosPanel
from tutorial.ros.chaos import FAULTS
from tutorial.ros.node_thread import NodeThread


@pytest.fixture
def listener(domain):
    with NodeThread("listener") as thread:
        thread.received = []
        thread.node.create_subscription(JointState, "/Tank/joint_state", thread.received.append, 10)
        yield thread


def move(slider, value):
    """What a page says may arrive on a thread of ipykernel's."""
    thread = threading.Thread(target=slider.set_trait, args=("value", value), name="subshell-1")
    thread.start()
    thread.join()


def test_a_slider_puts_a_fault_into_the_stream_and_the_button_takes_all_away(listener):
    async def main():
        panel = ChaosPanel()
        assert list(panel.sliders) == list(FAULTS)
        await until(lambda: listener.received, "a good message")
        assert not any(panel.made.values())
        move(panel.sliders["nan"], 1.0)
        await until(lambda: math.isnan(sum(listener.received[-1].position)), "a NaN")
        await until(lambda: panel._hits.value.startswith("messages hit: nan "), "the count")
        panel._reset.click()
        assert panel.sliders["nan"].value == 0
        await until(lambda: not math.isnan(sum(listener.received[-1].position)), "a good message again")
        panel.close()

    asyncio.run(main())


@pytest.mark.parametrize("leave", [ChaosPanel.end, ChaosPanel.close])
def test_ended_or_closed_it_publishes_no_more_and_leaves_no_thread(listener, leave):
    async def main():
        threads = threading.active_count()
        panel = ChaosPanel()
        move(panel.sliders["type"], 1.0)
        await until(lambda: panel.made["type"], "another type")
        leave(panel)
        leave(panel)
        assert panel.ended
        assert threading.active_count() == threads
        assert (panel.comm is None) == (leave is ChaosPanel.close)
        move(panel.sliders["nan"], 0.5)
        made = panel.made
        await asyncio.sleep(0)
        assert panel.made == made
        panel.close()

    asyncio.run(main())


def test_its_text_is_the_same_in_every_run(domain):
    async def main():
        panel = ChaosPanel()
        assert repr(panel) == "ChaosPanel()"
        panel.close()

    asyncio.run(main())


def test_what_cannot_be_leaves_nothing(domain):
    threads = threading.active_count()
    with pytest.raises(Exception, match=r"and none runs here\. Make it in a cell"):
        ChaosPanel()

    async def main():
        with pytest.raises(Exception, match="are both on '/Tank/joint_state'"):
            ChaosPanel(good="/Tank/joint_state")

    asyncio.run(main())
    assert threading.active_count() == threads
