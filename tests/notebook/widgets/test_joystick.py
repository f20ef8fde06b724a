"""The joystick in a cell: what it publishes, and when it lets go of the sticks."""

import math
import threading
from types import SimpleNamespace

import pytest
from programs import until
from sensor_msgs.msg import Joy

from tutorial.notebook.widgets.cell_widget import CellWidget
from tutorial.notebook.widgets.joystick import TIMEOUT, Joystick
from tutorial.ros.node_thread import NodeThread

from .pages import on_a_subshell

NEUTRAL = (0.0,) * 6
HELD = [0.5, 1.0, -0.25, 0.0, 0.0, 0.125]
BUTTONS = [1] + [0] * 14


@pytest.fixture
def clock(monkeypatch):
    """A clock that only the test moves; no page has been heard so far."""
    now = [100.0]
    monkeypatch.setattr(CellWidget, "heard_at", math.inf)
    monkeypatch.setattr(Joystick, "_clock", staticmethod(lambda: now[0]))
    return now


@pytest.fixture
def joystick(domain, clock, sent):
    widget = Joystick()
    yield widget
    widget.close()


@pytest.fixture
def heard(domain):
    messages = []
    with NodeThread("listener") as thread:
        thread.node.create_subscription(Joy, "joy", messages.append, 10)
        yield messages


def say(widget, axes=HELD, kind="sticks"):
    on_a_subshell(widget._handle_custom_msg, {"type": kind, "axes": axes, "buttons": BUTTONS}, [])


def is_heard(heard, axes):
    until(lambda: heard and list(heard[-1].axes) == list(axes), f"axes {axes}")
    return heard[-1]


def test_it_publishes_while_the_loop_is_blocked(joystick, heard):
    assert repr(joystick) == "Joystick()"
    assert list(is_heard(heard, NEUTRAL).buttons) == [0] * 15
    assert [timer.timer_period_ns for timer in joystick._node.timers] == [20_000_000]
    say(joystick)
    message = is_heard(heard, HELD)
    assert list(message.buttons) == BUTTONS
    assert message.header.frame_id == "joy"
    assert message.header.stamp.sec > 0


def test_it_lets_go_when_the_page_falls_silent(joystick, clock):
    say(joystick)
    clock[0] += 0.9 * TIMEOUT
    assert joystick.axes == tuple(HELD)
    say(joystick)  # the page repeats held sticks
    clock[0] += 0.9 * TIMEOUT
    assert joystick.axes == tuple(HELD)
    clock[0] += 0.2 * TIMEOUT
    assert joystick.axes == NEUTRAL


def test_a_closed_page_unplugs_the_joystick(joystick, monkeypatch):
    joystick._ros.close()  # this thread takes over the ticks
    joystick._timer = SimpleNamespace()
    published = []
    monkeypatch.setattr(joystick, "_publish", lambda: published.append(CellWidget.heard_at))
    monkeypatch.setattr(CellWidget, "heard_at", -math.inf)
    joystick._tick()
    assert not published
    assert joystick._timer.timer_period_ns == 1_000_000_000
    say(joystick)
    joystick._tick()
    assert published
    assert joystick._timer.timer_period_ns == 20_000_000


def test_senseless_messages_change_nothing(joystick):
    say(joystick, kind="hello")
    say(joystick, "all")
    joystick._handle_custom_msg("sticks", [])
    assert joystick.axes == NEUTRAL


@pytest.mark.parametrize("leave", [Joystick.close, Joystick.end])
def test_closed_or_ended_it_lets_go_and_leaves_no_thread(clock, sent, heard, leave):
    threads = threading.active_count()
    joystick = Joystick()
    say(joystick)
    is_heard(heard, HELD)
    leave(joystick)
    leave(joystick)
    say(joystick)
    assert joystick.ended
    assert joystick.axes == NEUTRAL
    is_heard(heard, NEUTRAL)
    assert threading.active_count() <= threads
    assert (joystick.comm is None) == (leave is Joystick.close)
    joystick.close()
