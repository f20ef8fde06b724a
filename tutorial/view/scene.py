"""Keeps what was drawn, so that a view that is opened later shows all of it.

A scene takes meshcat's commands. It knows no server and no notebook: it hands bytes to whatever is attached, and
``static/scene.js`` feeds them to meshcat's viewer in the browser.

A message is a row of records: the payload's length (four bytes, little-endian), one byte that says what it
is, the payload.
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
"""The most characters that the line under the view has."""

Sink = Callable[[bytes], None]
Vector = tuple[float, float, float]
Key = tuple[str, str, str]
"""What a record changes: its kind, a path, and a property. A later record replaces one with the same key."""

LINE: Key = ("line", "", "")
CAMERA: Key = ("camera", "", "")
_HEAD = struct.Struct("<IB")
_CAMERA = struct.Struct("<6d")
_FLOAT32 = 0x17
"""meshcat's MessagePack extension for a Float32Array (``meshcat/geometry.py``, ``threejs_type``)."""


class Record(IntEnum):
    """What a record of a message holds. ``static/scene.js`` has the same numbers."""

    COMMAND = 0
    """One meshcat command, in MessagePack."""
    LINE = 1
    """The line under the view, in UTF-8."""
    CLEAR = 2
    """Empty. The whole scene follows; it is always the first record."""
    CAMERA = 3
    """The camera's position and what it looks at [m]: six doubles, little-endian."""


def pack_command(command: dict[str, Any]) -> bytes:
    """Write a meshcat command as its viewer reads it. numpy's arrays become a Float32Array, in one row."""
    return msgpack.encode(command, enc_hook=_packed)


def unpack_command(payload: bytes) -> dict[str, Any]:
    """Read a command again, its Float32Arrays as ``(n,)``."""
    return msgpack.decode(payload, type=dict[str, Any], ext_hook=lambda _code, data: np.frombuffer(data, "<f4"))


def _packed(array: NDArray[np.float64]) -> msgpack.Ext:
    return msgpack.Ext(_FLOAT32, array.astype("<f4").tobytes())


def pack_record(kind: Record, payload: bytes) -> bytes:
    """Frame one record. A message is nothing but records one after the other."""
    return _HEAD.pack(len(payload), kind) + payload


def unpack_records(message: bytes) -> list[tuple[Record, bytes]]:
    """Take a message apart."""
    records, start = [], 0
    while start < len(message):
        length, kind = _HEAD.unpack_from(message, start)
        start += _HEAD.size + length
        records.append((Record(kind), message[start - length : start]))
    return records


class Scene:
    """Keeps what was drawn, and sends what changes to those that are attached, in one message a frame.

    It belongs to the thread that made it. What it holds does not grow with time: of each object, transform
    and property only the last one is kept, in the order in which they were last set, which is all that the
    picture depends on. What a viewer has to begin with, such as its grid, can be hidden, but not deleted.

    Attributes:
        catch_up: draws what was not drawn because nobody was attached.
    """

    def __init__(self) -> None:
        self._guard = ThreadGuard("the 3D view")
        self._kept: dict[Key, bytes] = {}
        self._frame: dict[Key, bytes] = {}
        self._sinks: list[Sink] = []
        self.catch_up: Callable[[], object] = lambda: None

    @property
    def watched(self) -> bool:
        """Whether anyone is attached. While nobody is, nothing needs to be drawn: `snapshot` catches up."""
        return bool(self._sinks)

    def send_message(self, message: dict[str, Any]) -> None:
        """Take one meshcat command. Those who are attached see it after the next `flush`.

        Args:
            message: such as ``{"type": "delete", "path": "/Bodies/Tank"}``.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.send_message")
        kind, path = message["type"], message["path"]
        if kind == "set_object":
            path = f"{path}/<object>"  # the viewer's name for it
        key = (kind, path, message.get("property", ""))
        if kind == "delete" or (kind == "set_object" and key in self._kept):
            self._forget(path)  # with its properties, which a new object comes without
        self._put(key, pack_record(Record.COMMAND, pack_command(message)), keep=kind != "delete")

    def line(self, text: str, table: Iterable[Iterable[str]] = ()) -> None:
        """Write one line under the view, and a small table below it. Without both there is nothing.

        They are shown as text, never as HTML. White space counts as one space, and what is longer than
        `LINE_LENGTH` is cut.

        Args:
            text: of the line.
            table: rows of cells. Those of the first row, and the first of each row, are headings.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.line")
        lines = [_cut(text), *("\t".join(map(_cut, row)) for row in table)]
        self._put(LINE, pack_record(Record.LINE, "\n".join(lines).encode("utf-8", "replace")))

    def look_at(self, position: Vector, target: Vector) -> None:
        """Place the camera. A view that was turned by hand stays as it is until the next call.

        Args:
            position: of the camera [m].
            target: the point in the middle of the picture [m], which the mouse turns the view about.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.look_at")
        self._put(CAMERA, pack_record(Record.CAMERA, _CAMERA.pack(*position, *target)))

    def flush(self) -> None:
        """Hand what changed since the last flush to everyone attached, as one message; if anything did.

        A sink that raises is logged and detached; the others still get theirs.

        Raises:
            WrongThreadError: called on another thread than the scene's.
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
                logger.exception("A view of the scene failed and is not shown any more.")
                self.detach(sink)

    def snapshot(self) -> bytes:
        """The whole scene as one message: what it shows is what all messages so far would have shown.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.snapshot")
        if not self.watched:
            self.catch_up()
        return pack_record(Record.CLEAR, b"") + b"".join(self._kept.values())

    def attach(self, sink: Sink) -> None:
        """Have every later message handed to `sink`. Show it a `snapshot` first. Idempotent.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.attach")
        if sink not in self._sinks:
            self._sinks.append(sink)

    def detach(self, sink: Sink) -> None:
        """Hand nothing more to `sink`. It need not be attached.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.detach")
        if sink in self._sinks:
            self._sinks.remove(sink)
        if not self._sinks:
            self._frame.clear()

    def _put(self, key: Key, record: bytes, keep: bool = True) -> None:
        if keep:
            self._kept.pop(key, None)  # it goes to the end
            self._kept[key] = record
        if self._sinks:
            self._frame.pop(key, None)
            self._frame[key] = record

    def _forget(self, path: str) -> None:
        """Drop all records of a path, and of those below it."""
        for records in (self._kept, self._frame):
            for key in [key for key in records if f"{key[1]}/".startswith(f"{path}/")]:
                del records[key]


def _cut(text: str) -> str:
    """Write a text as one line, not longer than `LINE_LENGTH`."""
    line = " ".join(text.split())
    return line if len(line) <= LINE_LENGTH else line[: LINE_LENGTH - 1] + "…"
