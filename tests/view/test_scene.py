"""A scene remembers what was drawn: its snapshot equals the result of all its messages."""

from itertools import count

import hypothesis.strategies as st
import numpy as np
import pytest
import umsgpack  # meshcat's packer
from hypothesis import given
from scenes import commands, lines, sends_away

from tutorial.view.scene import Record, Scene, pack_command, pack_record, unpack_command, unpack_records

PATHS = ["/a", "/a/b", "/a/b/c", "/ab", "/a/<object>", "/Grid", "/Lights/SpotLight"]


def set_object(path, shape):
    return {"type": "set_object", "path": path, "object": {"shape": shape}}


def set_transform(path, number):
    return {"type": "set_transform", "path": path, "matrix": [number] * 16}


def set_property(path, key, value):
    return {"type": "set_property", "path": path, "property": key, "value": value}


def delete(path):
    return {"type": "delete", "path": path}


paths = st.sampled_from(PATHS)
numbers = st.integers(0, 9)
any_command = st.one_of(
    st.builds(set_object, paths, numbers),
    st.builds(set_transform, paths, numbers),
    st.builds(set_property, paths, st.sampled_from(["position", "visible", "color"]), numbers),
    st.builds(delete, st.sampled_from([path for path in PATHS if path.startswith("/a")])),
)


class Viewer:
    """The parts of a browser's state that matter here, after meshcat's ``viewer/src/index.js``.

    Attributes:
        seen: values that differ from those of a new node, by path and key.
    """

    def __init__(self, message=b""):
        self.clear()
        self.read(message)

    def clear(self):
        self.seen = {(f"/{name}/<object>", "shape"): name for name in ("Grid", "Lights/SpotLight")}  # initially

    def read(self, message):
        for kind, payload in unpack_records(message):
            self.handle(unpack_command(payload)) if kind is Record.COMMAND else self.clear()

    def handle(self, command):
        path = command["path"]
        if command["type"] == "delete":
            self.forget(path)
        elif command["type"] == "set_object":  # a new object has its initial values and no children
            self.forget(f"{path}/<object>")
            self.seen[f"{path}/<object>", "shape"] = command["object"]["shape"]
        elif command["type"] == "set_transform":
            self.seen |= {(path, key): command["matrix"][0] for key in ("position", "rotation")}
        elif command["property"] == "color":
            self.seen |= {(each, "color"): command["value"] for each, key in self.below(path) if key == "shape"}
        else:
            self.seen[path, command["property"]] = command["value"]

    def forget(self, path):
        for each in self.below(path):
            del self.seen[each]

    def below(self, path):
        return [each for each in self.seen if f"{each[0]}/".startswith(f"{path}/")]


@given(st.lists(st.tuples(st.sampled_from(Record), st.binary(max_size=40))))
def test_a_message_splits_into_its_records(records):
    assert unpack_records(b"".join(pack_record(*record) for record in records)) == records


@given(st.lists(st.lists(any_command, max_size=6), max_size=6))
def test_the_snapshot_equals_all_messages(frames):
    scene, frame_by_frame, one_by_one = Scene(), Viewer(), Viewer()
    scene.attach(frame_by_frame.read)
    for frame in frames:
        for command in frame:
            scene.send_message(command)
            one_by_one.handle(command)
        scene.flush()
        assert frame_by_frame.seen == one_by_one.seen == Viewer(scene.snapshot()).seen


@given(st.lists(any_command, max_size=8), st.lists(any_command, max_size=8))
def test_a_viewer_that_joins_during_a_frame_sees_the_same(before, after):
    scene, first = Scene(), Viewer()
    scene.attach(first.read)
    for command in before:
        scene.send_message(command)
    late = Viewer(scene.snapshot())
    scene.attach(late.read)
    for command in after:
        scene.send_message(command)
    scene.flush()
    assert late.seen == first.seen


def test_a_frame_is_one_message_with_the_last_transform_of_each_path():
    scene, messages = Scene(), []
    scene.attach(messages.append)
    for number in range(3):
        scene.send_message(set_transform("/a", number))
        scene.send_message(set_transform("/b", number))
    scene.flush()
    scene.flush()
    [message] = messages
    assert commands(message) == [set_transform("/a", 2), set_transform("/b", 2)]


@pytest.mark.parametrize("attached", [False, True])
def test_memory_does_not_grow(attached):
    scene, passing = Scene(), count()
    if attached:
        scene.attach(lambda message: None)

    def a_while():
        for number in range(300):
            scene.send_message(set_object("/a", number % 10))
            scene.send_message(set_transform("/a", number % 10))
            scene.send_message(set_property("/a", "visible", number % 10))
            scene.send_message(set_object(path := f"/passing/{next(passing)}", 1))
            scene.send_message(delete(path))
            scene.line(f"{number % 10}")
            scene.look_at((number, 0, 0), (0, 0, 0))
            scene.flush()
        return len(scene.snapshot()), len(scene._kept), len(scene._frame)

    assert a_while() == a_while()


def test_a_command_is_packed_like_meshcats():
    points = np.arange(12, dtype=np.float32).reshape(4, 3)
    command = {"type": "set_object", "object": [-1, 2**40, 0.1, None, True, "é" * 300, [0] * 16, {"a": {}}]}
    row = umsgpack.Ext(0x17, points.tobytes())  # a Float32Array: ``threejs_type`` in meshcat's geometry.py
    assert pack_command({**command, "array": points}) == umsgpack.packb({**command, "array": row})
    assert unpack_command(pack_command(command)) == command
    np.testing.assert_array_equal(unpack_command(pack_command({"array": points}))["array"], points.reshape(-1))


def test_the_lines_below_the_view_are_short_text():
    scene = Scene()
    for text, table, expected in (
        ("<b>joint</b>\n x\ud800", [], "<b>joint</b> x?"),
        (200 * "x", [], 200 * "x"),
        (201 * "x", [("", "x"), ("a\tname\n", 300 * "1")], f"{199 * 'x'}…\n\tx\na name\t{199 * '1'}…"),
        ("", [], ""),
    ):
        scene.line(text, table)
        assert lines(scene.snapshot()) == [expected]


def test_every_attached_function_gets_each_message_once_even_if_one_fails(caplog):
    scene, messages = Scene(), []
    sink = messages.append

    def broken(message):
        raise OSError("gone")

    for each in (broken, sink):
        scene.attach(each)
    for text in ("one", "two"):
        scene.line(text)
        scene.flush()
    assert [lines(message) for message in messages] == [["one"], ["two"]]
    assert caplog.text.count("OSError: gone") == 1
    scene.detach(sink)
    scene.detach(sink)
    scene.line("three")
    scene.flush()
    assert len(messages) == 2


def test_another_thread_is_refused():
    calls = {
        "send_message": [delete("/a")],
        "line": ["text"],
        "attach": [print],
        "detach": [print],
        "flush": [],
        "snapshot": [],
        "look_at": [(1, 1, 1), (0, 0, 0)],
    }
    for method, arguments in calls.items():
        assert sends_away(Scene(), method, *arguments), method
