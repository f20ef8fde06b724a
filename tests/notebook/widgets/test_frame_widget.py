"""The protocol of frames: what each view receives, and until when."""

import pytest

from tutorial.errors import TutorialError
from tutorial.notebook.widgets.frame_widget import FrameWidget

from .pages import say


class Numbers(FrameWidget):
    """Shows one number after another."""

    AHEAD = 3
    _esm = "export default {}"
    newest = 0

    def whole(self):
        return bytes([self.newest]), {"text": str(self.newest)}

    def show(self, *numbers):
        for self.newest in numbers:
            content, fields = self.whole()
            self.send_frame(content, **fields)


def taken(sent):
    """Return and clear the sent messages: (type, number of the frame, the shown number)."""
    messages = [(content["type"], content["frame"], buffers[0][0]) for content, buffers in sent]
    sent.clear()
    return messages


async def test_a_view_gets_the_whole_and_then_each_frame_until_its_bye(sent):
    widget = Numbers("numbers")
    assert repr(widget) == "Numbers('numbers')"
    widget.show(1)
    assert sent == []
    await say(widget, "hello")
    assert sent == [({"type": "whole", "view": "page", "frame": 0, "text": "1"}, [b"\1"])]
    sent.clear()
    widget.show(2)
    assert sent == [({"type": "frame", "frame": 1, "text": "2"}, [b"\2"])]
    await say(widget, "bye")
    widget.show(3)
    assert len(sent) == 1


async def test_a_silent_view_gets_nothing_and_catches_up_with_the_whole(sent):
    widget = Numbers("numbers")
    await say(widget, "hello")
    widget.show(*range(1, 10))
    assert taken(sent) == [("whole", 0, 0), ("frame", 1, 1), ("frame", 2, 2)]
    assert len(widget._seen) == 0
    await say(widget, "seen", frame=1)
    assert taken(sent) == [("whole", 2, 9)]
    await say(widget, "seen", frame=2)
    widget.show(10)
    assert taken(sent) == [("frame", 3, 10)]


async def test_a_sleeping_view_does_not_slow_down_another(sent):
    widget = Numbers("numbers")
    for view in ("awake", "asleep"):
        await say(widget, "hello", view)
    sent.clear()
    for number in range(1, 10):
        widget.show(number)
        await say(widget, "seen", "awake", frame=number)
    assert [number for _, _, number in taken(sent)] == [*range(1, 10)]
    assert len(widget._seen) == 1


async def test_senseless_messages_are_ignored(sent):
    widget = Numbers("numbers")
    for content in (None, "hello", {}, {"type": "hello"}, {"type": "hello", "view": 3}, {"type": "what", "view": "x"}):
        widget._handle_custom_msg(content, [])
    await say(widget, "seen", frame="many")
    assert (sent, len(widget._seen)) == ([], 0)


def test_without_an_event_loop_it_is_refused():
    with pytest.raises(TutorialError, match=r"none is running here\. Create the widget in a cell"):
        Numbers("numbers")
