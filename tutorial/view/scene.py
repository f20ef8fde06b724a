"""A meshcat window that keeps the scene, so that whoever looks later sees all of it.

``meshcat.Visualizer(window=Scene())`` draws into it as into any other window. A scene knows no server and no
notebook: it hands bytes to whatever is attached, and ``static/scene.js`` feeds them to the viewer in the
browser.

A message is a row of records: the payload's length (four bytes, little-endian), one byte that says what it
is, the payload.
"""

from __future__ import annotations

import logging
import struct
from collections.abc import Callable, Iterable
from enum import IntEnum
from typing import Any, Protocol

import numpy as np
from msgspec import msgpack

from tutorial.errors import TutorialError, did_you_mean
from tutorial.handoff import ThreadGuard

__all__ = [
    "LINE_LENGTH",
    "MESHCATS_LIGHTS",
    "Command",
    "Record",
    "Scene",
    "Sink",
    "pack_command",
    "pack_record",
    "unpack_command",
    "unpack_records",
]

logger = logging.getLogger(__name__)

LINE_LENGTH = 200
"""The most characters that the line under the view has."""

Sink = Callable[[bytes], None]
Vector = tuple[float, float, float]

_HEAD = struct.Struct("<IB")
_CAMERA = struct.Struct("<6d")
_FLOAT32 = 0x17
"""meshcat's MessagePack extension for a Float32Array (``meshcat/geometry.py``, ``threejs_type``)."""

_KINDS = ("set_object", "set_transform", "set_property", "set_animation", "delete")

MESHCATS_LIGHTS = ("SpotLight", "PointLightNegativeX", "PointLightPositiveX", "AmbientLight", "FillLight")
_NODES = ("Axes", "Background", "Cameras", "Cameras/default", "Cameras/default/rotated", "Grid", "Lights")
_PATHS = [f"/{node}" for node in _NODES] + [f"/Lights/{light}" for light in MESHCATS_LIGHTS]
_EVERY_VIEWER_HAS = frozenset(path + end for path in _PATHS for end in ("", "/<object>"))


class Record(IntEnum):
    """What a record of a message holds. ``static/scene.js`` has the same numbers."""

    COMMAND = 0
    """One meshcat command, in MessagePack."""
    LINE = 1
    """The line under the view, in UTF-8."""
    CLEAR = 2
    """Nothing; the whole scene follows. Only ever the first record."""
    CAMERA = 3
    """The camera's position and what it looks at [m]: six doubles, little-endian."""


class Command(Protocol):
    """What meshcat sends to a window, for instance ``meshcat.commands.SetTransform``."""

    def lower(self) -> dict[str, Any]:
        """Say it in dictionaries, lists, strings and numbers."""
        ...


def pack_command(command: dict[str, Any]) -> bytes:
    """Write a meshcat command as its viewer reads it. numpy's arrays become a Float32Array, in one row.

    Raises:
        TypeError: it holds something that is neither text, number, list, dictionary nor array.
    """
    return msgpack.encode(command, enc_hook=_lowered)


def unpack_command(payload: bytes) -> dict[str, Any]:
    """Read a command again, its Float32Arrays as ``(n,)``.

    Raises:
        msgspec.DecodeError: it is none.
    """
    return msgpack.decode(payload, type=dict[str, Any], ext_hook=_raised)


def pack_record(kind: Record, payload: bytes) -> bytes:
    """Frame one record. A message is nothing but records one after the other."""
    return _HEAD.pack(len(payload), kind) + payload


def unpack_records(message: bytes) -> list[tuple[Record, bytes]]:
    """Take a message apart.

    Raises:
        ValueError: the message ends within a record, or holds a kind that there is not.
    """
    records = []
    start = 0
    while start < len(message):
        if start + _HEAD.size > len(message):
            raise ValueError("the message ends within the head of a record")
        length, kind = _HEAD.unpack_from(message, start)
        start += _HEAD.size
        if start + length > len(message):
            raise ValueError(f"the last record has {len(message) - start} bytes of {length}")
        records.append((Record(kind), message[start : start + length]))
        start += length
    return records


class Scene:
    """Keeps what was drawn, and tells those that are attached what changes, one message a frame.

    It belongs to the thread that made it. What it holds does not grow with time: of each object, transform
    and property only the last one is kept, in the order in which they were last set, which is all that the
    picture depends on.
    """

    def __init__(self) -> None:
        self._guard = ThreadGuard("the 3D view")
        self._kept: dict[tuple[str, ...], bytes] = {}
        self._frame: dict[tuple[str, ...], bytes] = {}
        self._paths: set[str] = set()
        self._sinks: list[Sink] = []

    def send(self, command: Command) -> None:
        """Take one meshcat command. It is part of the scene at once, and of what others see after `flush`.

        Raises:
            TutorialError: the command needs an answer from a browser (`capture_image`), or deletes ``/``.
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.send")
        self.send_message(command.lower())

    def send_message(self, message: dict[str, Any]) -> None:
        """Take one command that is written out already, as ``command.lower()`` returns it.

        Raises:
            TutorialError: as `send`.
            WrongThreadError: called on another thread than the scene's.
        """
        kind = str(message["type"])
        if kind not in _KINDS:
            raise TutorialError(f"this 3D view cannot do {kind!r}.{did_you_mean(kind, _KINDS)}")
        path = _tidy(str(message.get("path", "")))
        if kind == "set_object":
            path = _tidy(f"{path}/<object>")  # the viewer's name for it
        if kind in ("set_object", "delete"):
            self._forget(path)  # with its properties, which a new object comes without
        self.send_packed((kind, path, str(message.get("property", ""))), pack_command(message))

    def send_packed(self, key: tuple[str, ...], command: bytes) -> None:
        """Take a command that is packed already: what is called for each body in each frame.

        Args:
            key: what it replaces if it comes again, for a transform ``("set_transform", path, "")``.
            command: in MessagePack.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.send_packed")
        keep = key[0] != "delete" or key[1] in _EVERY_VIEWER_HAS
        self._put(key, pack_record(Record.COMMAND, command), keep)

    def line(self, text: str, table: Iterable[Iterable[str]] = ()) -> None:
        """Say one line under the view, and a small table below it; without both there is nothing.

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
        self._put(("line",), pack_record(Record.LINE, "\n".join(lines).encode("utf-8", "replace")))

    def look_at(self, position: Vector, target: Vector) -> None:
        """Place the camera. Whoever has turned the view by hand keeps it until the next call.

        Args:
            position: of the camera [m].
            target: the point in the middle of the picture [m], which the mouse turns the view about.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._guard.check("Scene.look_at")
        self._put(("camera",), pack_record(Record.CAMERA, _CAMERA.pack(*position, *target)))

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
        return pack_record(Record.CLEAR, b"") + b"".join(self._kept.values())

    def attach(self, sink: Sink) -> None:
        """Have every later message handed to `sink`. Show it a `snapshot` first. Twice is once.

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

    def _put(self, key: tuple[str, ...], record: bytes, keep: bool = True) -> None:
        if keep:
            if self._kept.pop(key, None) is None:  # it goes to the end
                self._note(*key[1:2])
            self._kept[key] = record
        if self._sinks:
            self._frame.pop(key, None)
            self._frame[key] = record

    def _note(self, path: str = "") -> None:
        """Remember that there is something at this path, and so below all that lead to it."""
        while path and path not in self._paths:
            self._paths.add(path)
            path = path.rpartition("/")[0]

    def _forget(self, path: str) -> None:
        if path == "/":
            raise TutorialError("meshcat cannot delete '/'. Delete what is below it, path by path.")
        if path not in self._paths:  # as for each object of a new body: no need to look through all the others
            return
        for records in (self._kept, self._frame):
            for key in [key for key in records if len(key) > 1 and _is_below(key[1], path)]:
                del records[key]
        self._paths = {other for other in self._paths if not _is_below(other, path)}


def _cut(text: str) -> str:
    """One line of it, and not too much."""
    line = " ".join(text.split())
    return line if len(line) <= LINE_LENGTH else line[: LINE_LENGTH - 1] + "…"


def _lowered(value: object) -> object:
    """What MessagePack has for numpy's numbers and arrays, and for the arrays that meshcat has packed by itself."""
    match value:
        case np.ndarray():
            return msgpack.Ext(_FLOAT32, value.astype("<f4").tobytes())
        case np.generic():
            return value.item()
        case object(type=int(code), data=bytes(data)):
            return msgpack.Ext(code, data)
    raise TypeError(f"a command of the 3D view cannot hold a {type(value).__name__}: {value!r}")


def _raised(code: int, data: memoryview) -> object:
    return np.frombuffer(data, "<f4") if code == _FLOAT32 else msgpack.Ext(code, bytes(data))


def _tidy(path: str) -> str:
    return "/" + "/".join(part for part in path.split("/") if part)


def _is_below(other: str, path: str) -> bool:
    return other == path or other.startswith(f"{path}/")
