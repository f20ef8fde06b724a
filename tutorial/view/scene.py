"""The scene: it stores everything that was drawn, so that views opened later can show it.

A scene accepts meshcat's commands. It depends on neither a server nor a notebook: it passes bytes to the attached
sinks, and ``static/scene.js`` feeds them to meshcat's viewer in the browser.

A message is a sequence of records. A record consists of its payload's length (four bytes, little-endian), its kind (one
byte) and the payload.
"""

import logging
import struct
from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import Any

import numpy as np
from msgspec import msgpack
from numpy.typing import NDArray

from tutorial.handoff import ThreadGuard

logger = logging.getLogger(__name__)

LINE_LENGTH = 200
"""The maximum number of characters in the line below the view."""

Sink = Callable[[bytes], None]
Vector = tuple[float, float, float]
Key = tuple[str, str, str]
"""Identifies the part that a record changes: kind, path and property.

A record replaces any earlier one with the same key.
"""

LINE: Key = ("line", "", "")
CAMERA: Key = ("camera", "", "")
_HEAD = struct.Struct("<IB")
_CAMERA = struct.Struct("<6d")
_FLOAT32 = 0x17
"""The MessagePack extension type that meshcat uses for a Float32Array (``meshcat/geometry.py``, ``threejs_type``)."""


class Record(IntEnum):
    """The kinds of records. ``static/scene.js`` uses the same numbers."""

    COMMAND = 0
    """One meshcat command, in MessagePack."""
    LINE = 1
    """The line below the view, in UTF-8."""
    CLEAR = 2
    """A record without content, always the first in its message. The records of the whole scene follow."""
    CAMERA = 3
    """The camera's position and target [m]: six doubles, little-endian."""


def pack_command(command: dict[str, Any]) -> bytes:
    """Serialize a meshcat command for meshcat's viewer. NumPy arrays become flat Float32Arrays."""
    return msgpack.encode(command, enc_hook=_packed)


def unpack_command(payload: bytes) -> dict[str, Any]:
    """Parse a serialized command. Float32Arrays become arrays of shape ``(n,)``."""
    return msgpack.decode(payload, type=dict[str, Any], ext_hook=lambda _code, data: np.frombuffer(data, "<f4"))


def _packed(array: NDArray[np.float64]) -> msgpack.Ext:
    return msgpack.Ext(_FLOAT32, array.astype("<f4").tobytes())


def pack_record(kind: Record, payload: bytes) -> bytes:
    """Serialize one record. Concatenated records form a message."""
    return _HEAD.pack(len(payload), kind) + payload


def unpack_records(message: bytes) -> list[tuple[Record, bytes]]:
    """Split a message into its records."""
    records, start = [], 0
    while start < len(message):
        length, kind = _HEAD.unpack_from(message, start)
        start += _HEAD.size + length
        records.append((Record(kind), message[start - length : start]))
    return records


class Scene:
    """Stores everything that was drawn, and sends each frame's changes to the attached sinks as one message.

    Use it on the thread that made it. Its size does not grow with time: it stores only the latest value of each object,
    transform and property, in the order in which they last changed, because nothing else affects the view. A viewer's
    built-in objects, such as its grid, can be hidden, but not deleted.

    Attributes:
        catch_up: a function that draws the changes that were skipped while no sink was attached.
    """

    def __init__(self) -> None:
        self._guard = ThreadGuard("the 3D view")
        self._kept: dict[Key, bytes] = {}
        self._frame: dict[Key, bytes] = {}
        self._sinks: list[Sink] = []
        self.catch_up: Callable[[], object] = lambda: None

    @property
    def watched(self) -> bool:
        """Whether a sink is attached. If none is, changes need not be drawn, because `snapshot` draws them later."""
        return bool(self._sinks)

    def send_message(self, message: dict[str, Any]) -> None:
        """Accept one meshcat command. The attached sinks receive it at the next `flush`.

        Args:
            message: a command such as ``{"type": "delete", "path": "/Bodies/Tank"}``.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self._guard.check("Scene.send_message")
        kind, path = message["type"], message["path"]
        if kind == "set_object":
            path = f"{path}/<object>"  # the viewer's name for the object
        key = (kind, path, message.get("property", ""))
        if kind == "delete" or (kind == "set_object" and key in self._kept):
            self._forget(path)  # also forgets the old object's properties, which a new object does not inherit
        self._put(key, pack_record(Record.COMMAND, pack_command(message)), keep=kind != "delete")

    def line(self, text: str, table: Iterable[Iterable[str]] = ()) -> None:
        """Write one line below the view, and a small table below that line. If both are empty, show nothing.

        Both appear as plain text, never as HTML. White space is collapsed, and strings are truncated to `LINE_LENGTH`.

        Args:
            text: the text of the line.
            table: rows of cells. The first row and the first column are headings.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self._guard.check("Scene.line")
        lines = [_cut(text), *("\t".join(map(_cut, row)) for row in table)]
        self._put(LINE, pack_record(Record.LINE, "\n".join(lines).encode("utf-8", "replace")))

    def look_at(self, position: Vector, target: Vector) -> None:
        """Place the camera in all views. If the user then turns a view, it stays turned until the next call.

        Args:
            position: the camera's position [m].
            target: the point in the middle of the view [m], about which the mouse turns the view.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self._guard.check("Scene.look_at")
        self._put(CAMERA, pack_record(Record.CAMERA, _CAMERA.pack(*position, *target)))

    def flush(self) -> None:
        """If anything has changed since the last flush, send all changes to the attached sinks as one message.

        If a sink raises an exception, log it and detach the sink; the other sinks still receive the message.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self._guard.check("Scene.flush")
        if not self._frame:
            return
        message = b"".join(self._frame.values())
        self._frame.clear()
        for sink in tuple(self._sinks):
            try:
                sink(message)
            except Exception:
                logger.exception("A view of the scene failed and is no longer updated.")
                self.detach(sink)

    def snapshot(self) -> bytes:
        """Return the whole scene as one message, which replaces all earlier messages.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self._guard.check("Scene.snapshot")
        if not self.watched:
            self.catch_up()
        return pack_record(Record.CLEAR, b"") + b"".join(self._kept.values())

    def attach(self, sink: Sink) -> None:
        """Pass every later message to `sink`, which must receive a `snapshot` first. Idempotent.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self._guard.check("Scene.attach")
        if sink not in self._sinks:
            self._sinks.append(sink)

    def detach(self, sink: Sink) -> None:
        """Stop passing messages to `sink`, if it is attached.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self._guard.check("Scene.detach")
        if sink in self._sinks:
            self._sinks.remove(sink)
        if not self._sinks:
            self._frame.clear()

    def _put(self, key: Key, record: bytes, keep: bool = True) -> None:
        if keep:
            self._kept.pop(key, None)  # to move it to the end
            self._kept[key] = record
        if self._sinks:
            self._frame.pop(key, None)
            self._frame[key] = record

    def _forget(self, path: str) -> None:
        """Drop all records of a path and of the paths below it."""
        for records in (self._kept, self._frame):
            for key in [key for key in records if f"{key[1]}/".startswith(f"{path}/")]:
                del records[key]


def _cut(text: str) -> str:
    """Collapse text into one line of at most `LINE_LENGTH` characters."""
    line = " ".join(text.split())
    return line if len(line) <= LINE_LENGTH else line[: LINE_LENGTH - 1] + "…"
