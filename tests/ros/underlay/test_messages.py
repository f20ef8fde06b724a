"""Message classes are those that ROS 2 generates: what they hold, convert, check and say."""

from __future__ import annotations

import copy
import math
import pickle
import re
import subprocess
from array import array
from collections import UserList, UserString
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point, Polygon, Quaternion, Twist, Vector3
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nav_msgs.msg import OccupancyGrid
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor, ParameterValue
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import Image, Imu, JointState, Joy, NavSatStatus
from shape_msgs.msg import MeshTriangle, SolidPrimitive
from std_msgs.msg import Byte, ByteMultiArray, Char, Empty, Float32, Float64, Header, Int8, String, UInt8
from type_description_interfaces.msg import FieldType
from unique_identifier_msgs.msg import UUID

from tutorial import ros_backend

ALL_TYPES = sorted(get_typestore(Stores.ROS2_JAZZY).fielddefs)
NUMBER_CODES = {"float": "f", "double": "d"} | {
    f"{sign}int{bits}": code.upper() if sign else code
    for bits, code in ((8, "b"), (16, "h"), (32, "i"), (64, "q"))
    for sign in ("", "u")
}


def message_class(type_name: str) -> type[Any]:
    """Import a class; a small installation of a real ROS 2 has not every package."""
    package, _, name = type_name.split("/")
    module = pytest.importorskip(f"{package}.msg") if ros_backend() == "rclpy" else import_module(f"{package}.msg")
    found: type[Any] = getattr(module, name)
    return found


def parts(field_type: str) -> tuple[str, str, int]:
    """Take ``"sequence<double, 3>"`` apart: ``("double", "sequence", 3)``."""
    if several := re.fullmatch(r"sequence<(.*?)(?:, (\d+))?>", field_type):
        return several[1], "sequence", int(several[2] or 0)
    if several := re.fullmatch(r"(.*)\[(\d+)\]", field_type):
        return several[1], "array", int(several[2])
    return field_type, "", 0


def is_default(value: Any, field_type: str) -> bool:
    """Whether a value is what a field of a type has if nothing else is given."""
    element, several, size = parts(field_type)
    code = NUMBER_CODES.get(element)
    if several == "array":
        return type(value) is np.ndarray and value.dtype == np.dtype(code) and value.tolist() == [0] * size
    if several:
        return bool(type(value) is array and value.typecode == code if code else type(value) is list) and not value
    if "/" in element:
        return isinstance(value, message_class(element.replace("/", "/msg/")))
    zero = {"boolean": False, "octet": b"\0"}.get(element, "" if element.startswith("string") else 0)
    return bool(value == zero) and type(value) is (float if element in ("float", "double") else type(zero))


@pytest.mark.parametrize("package", sorted({name.partition("/")[0] for name in ALL_TYPES}))
def test_every_type_has_topics(package: str, node: Node) -> None:
    for type_name in (name for name in ALL_TYPES if name.startswith(f"{package}/")):
        cls = message_class(type_name)
        publisher = node.create_publisher(cls, f"topic_of_{cls.__name__}", 1)
        publisher.publish(cls())
        node.destroy_publisher(publisher)


@pytest.mark.parametrize("type_name", ALL_TYPES)
def test_every_type(type_name: str) -> None:
    package, _, name = type_name.split("/")
    cls = message_class(type_name)
    message = cls()
    types = cls.get_fields_and_field_types()

    assert cls.__module__ == f"{package}.msg._{module_name(name)}"
    assert getattr(import_module(cls.__module__), name) is cls
    assert cls.__slots__ == [*(f"_{field}" for field in types), "_check_fields"]
    others = [field for field in types if not is_default(getattr(message, field), types[field])]
    assert others == {"Quaternion": ["w"], "NavSatStatus": ["status"]}.get(name, [])
    assert repr(message).startswith(f"{package}.msg.{name}({next(iter(types), '')}")
    assert str(message) == repr(message)
    assert message == cls()
    assert message != 3
    for again in copy.copy, copy.deepcopy, lambda message: pickle.loads(pickle.dumps(message)), carried:
        assert again(message) == message
        assert repr(again(message)) == repr(message)
    with pytest.raises(TypeError, match="unhashable"):
        hash(message)
    with pytest.raises(AttributeError, match=f"'{name}' object has no attribute 'nonsense'"):
        message.nonsense = 1


def module_name(name: str) -> str:
    """``JointState`` is in ``_joint_state``, ``ColorRGBA`` in ``_color_rgba``, ``PointCloud2`` in ``_point_cloud2``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=.)(?=[A-Z][a-z])", "_", name).lower()


def carried(message: Any) -> Any:
    """Send a message through its bytes."""
    return deserialize_message(serialize_message(message), type(message))


def values(field_type: str) -> st.SearchStrategy[Any]:
    """Anything that a field of a type can hold."""
    element, several, size = parts(field_type)
    if "/" in element:
        one: st.SearchStrategy[Any] = st.deferred(lambda: messages(element.replace("/", "/msg/")))
    elif element.startswith("string"):
        one = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=8)
    elif element in ("float", "double"):
        one = st.floats(width=32 if element == "float" else 64, allow_nan=False)
    elif element in ("boolean", "octet"):
        one = st.booleans() if element == "boolean" else st.binary(min_size=1, max_size=1)
    else:
        limits = np.iinfo(NUMBER_CODES[element])
        one = st.integers(int(limits.min), int(limits.max))
    if several:
        return st.lists(one, min_size=size if several == "array" else 0, max_size=size or 2)
    return one


def messages(type_name: str) -> st.SearchStrategy[Any]:
    """Any message of a type."""
    cls = message_class(type_name)
    return st.builds(cls, **{name: values(kind) for name, kind in cls.get_fields_and_field_types().items()})


@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_any_message_is_carried(data: st.DataObject) -> None:
    message = data.draw(messages(data.draw(st.sampled_from(ALL_TYPES))))
    assert carried(message) == message
    assert repr(carried(message)) == repr(message)


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (Empty(), "std_msgs.msg.Empty()"),
        (Byte(data=b"\5"), "std_msgs.msg.Byte(data=b'\\x05')"),
        (Char(), "std_msgs.msg.Char(data=0)"),
        (String(data="it's"), 'std_msgs.msg.String(data="it\'s")'),
        (Quaternion(), "geometry_msgs.msg.Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)"),
        (
            JointState(name=["a"], position=[1], velocity=(math.nan, -math.inf)),
            "sensor_msgs.msg.JointState(header=std_msgs.msg.Header(stamp=builtin_interfaces.msg.Time(sec=0, "
            "nanosec=0), frame_id=''), name=['a'], position=[1.0], velocity=[nan, -inf], effort=[])",
        ),
        (MeshTriangle(), "shape_msgs.msg.MeshTriangle(vertex_indices=array([0, 0, 0], dtype=uint32))"),
        (
            SolidPrimitive(type=SolidPrimitive.BOX, dimensions=[1, 2, 3]),
            "shape_msgs.msg.SolidPrimitive(type=1, dimensions=[1.0, 2.0, 3.0], "
            "polygon=geometry_msgs.msg.Polygon(points=[]))",
        ),
        (
            DiagnosticStatus(level=DiagnosticStatus.WARN, values=[KeyValue(key="k")]),
            "diagnostic_msgs.msg.DiagnosticStatus(level=b'\\x01', name='', message='', hardware_id='', "
            "values=[diagnostic_msgs.msg.KeyValue(key='k', value='')])",
        ),
    ],
    ids=lambda value: type(value).__name__ if hasattr(value, "get_fields_and_field_types") else "",
)
def test_repr(message: Any, text: str) -> None:
    assert repr(message) == text
    assert repr(carried(message)) == text


@pytest.mark.parametrize(
    ("cls", "field", "given", "kept"),
    [
        (JointState, "position", [1, 2], array("d", [1.0, 2.0])),
        (JointState, "position", {0.5}, array("d", [0.5])),
        (JointState, "position", np.array([1.0, 2.0], np.float32), array("d", [1.0, 2.0])),
        (JointState, "position", array("f", [0.5]), array("d", [0.5])),
        (Joy, "axes", [1], array("f", [1.0])),
        (Joy, "buttons", (True, 0), array("i", [1, 0])),
        (Image, "data", b"\1\2", array("B", [1, 2])),
        (Image, "data", bytearray(b"\1\2"), array("B", [1, 2])),
        (OccupancyGrid, "data", [-1, 100], array("b", [-1, 100])),
        (Imu, "orientation_covariance", range(9), np.arange(9, dtype=np.float64)),
        (MeshTriangle, "vertex_indices", [1, 2, 3], np.array([1, 2, 3], np.uint32)),
        (UUID, "uuid", bytearray(range(16)), np.arange(16, dtype=np.uint8)),
        (JointState, "name", ("a", "b"), ("a", "b")),
        (ParameterValue, "bool_array_value", [True], [True]),
        (ByteMultiArray, "data", [b"a"], [b"a"]),
        (Vector3, "x", 1, 1),
        (Time, "sec", 2.5, 2.5),
        (String, "data", None, None),
    ],
)
@pytest.mark.parametrize("way", ["keyword", "assigned"])
def test_a_value_is_converted_to_its_container_or_kept(cls: Any, field: str, given: Any, kept: Any, way: str) -> None:
    message = cls(**{field: given} if way == "keyword" else {})
    if way == "assigned":
        setattr(message, field, given)
    value = getattr(message, field)
    assert type(value) is type(kept)
    if isinstance(kept, np.ndarray):
        assert value.dtype == kept.dtype
        assert value.tolist() == kept.tolist()
    else:
        assert value == kept
        assert getattr(value, "typecode", "") == getattr(kept, "typecode", "")


@pytest.mark.parametrize(
    ("cls", "field", "given", "error"),
    [
        (JointState, "position", "abc", TypeError),
        (JointState, "position", 3, TypeError),
        (JointState, "position", ["a"], TypeError),
        (Joy, "buttons", [2**40], OverflowError),
        (Joy, "buttons", [0.5], TypeError),
        (Image, "data", [256], OverflowError),
        (UUID, "uuid", bytes(range(65, 81)), ValueError),
        (Imu, "orientation_covariance", ["a"] * 9, ValueError),
    ],
)
def test_what_no_container_can_hold(cls: Any, field: str, given: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        setattr(cls(), field, given)
    with pytest.raises(error):
        cls(**{field: given})


def test_numbers_are_copied_and_lists_are_not() -> None:
    positions, covariance, names = array("d", [1.0]), np.zeros(9), ["a"]
    message, imu = JointState(name=names, position=positions), Imu(orientation_covariance=covariance)
    positions[0] = covariance[0] = 2.0
    assert message.position[0] == 1.0
    assert imu.orientation_covariance[0] == 0.0
    assert message.name is names


def test_default_values_are_not_shared() -> None:
    first, second = JointState(), JointState()
    first.name.append("a")
    first.position.append(1.0)
    first.header.frame_id = "map"
    assert second == JointState()


def test_copies() -> None:
    message = Twist(linear=Vector3(x=1.0))
    shallow, deep = copy.copy(message), copy.deepcopy(message)
    message.linear.x = 2.0
    assert (shallow.linear.x, deep.linear.x) == (2.0, 1.0)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (JointState(name=["a"]), JointState(name=["b"])),
        (JointState(name=["a"]), JointState(name=("a",))),
        (JointState(position=[1.0]), JointState(position=[1.0, 2.0])),
        (Header(stamp=Time(sec=1)), Header(stamp=Time(sec=2))),
        (Imu(orientation_covariance=[0] * 9), Imu(orientation_covariance=[1] * 9)),
        (Polygon(), Point()),
        (Int8(), UInt8()),
    ],
)
def test_messages_that_differ(one: Any, other: Any) -> None:
    assert one != other
    assert other != one


def test_constants() -> None:
    assert NavSatStatus.STATUS_NO_FIX == NavSatStatus().STATUS_NO_FIX == -1
    assert DiagnosticStatus.ERROR == b"\2"
    with pytest.raises(AttributeError):
        NavSatStatus.STATUS_NO_FIX = 0
    with pytest.raises(AttributeError, match="read-only"):
        NavSatStatus().STATUS_NO_FIX = 0


def test_the_field_types_are_a_copy() -> None:
    Header.get_fields_and_field_types().clear()
    assert Header().get_fields_and_field_types() == {"stamp": "builtin_interfaces/Time", "frame_id": "string"}


def test_a_field_cannot_be_deleted() -> None:
    with pytest.raises(AttributeError):
        del Header().stamp


DOUBLE = f"{1.7976931348623157e308:f}"
FLOAT = f"{3.402823466e38:f}"


@pytest.mark.parametrize(
    ("cls", "field", "value", "problem"),
    [
        (JointState, "header", 3, "field must be a sub message of type 'Header'"),
        (JointState, "name", "ab", "field must be a set or sequence and each value of type 'str'"),
        (JointState, "name", [1], "field must be a set or sequence and each value of type 'str'"),
        (JointState, "name", UserString("ab"), "field must be a set or sequence and each value of type 'str'"),
        (
            JointState,
            "position",
            [1],
            f"field must be a set or sequence and each value of type 'float' and each double in [-{DOUBLE}, {DOUBLE}]",
        ),
        (JointState, "position", array("f"), "array.array() must have the type code of 'd'"),
        (
            JointState,
            "position",
            np.zeros(2),
            f"field must be a set or sequence and each value of type 'float' and each double in [-{DOUBLE}, {DOUBLE}]",
        ),
        (
            Joy,
            "axes",
            [1e39],
            f"field must be a set or sequence and each value of type 'float' and each float in [-{FLOAT}, {FLOAT}]",
        ),
        (
            Joy,
            "buttons",
            [2**31],
            "field must be a set or sequence and each value of type 'int' "
            "and each integer in [-2147483648, 2147483647]",
        ),
        (
            Image,
            "data",
            [-1],
            "field must be a set or sequence and each value of type 'int' and each unsigned integer in [0, 255]",
        ),
        (
            SolidPrimitive,
            "dimensions",
            [0.0] * 4,
            "field must be a set or sequence with length <= 3 and each value of type 'float' "
            f"and each double in [-{DOUBLE}, {DOUBLE}]",
        ),
        (SolidPrimitive, "dimensions", array("d", [0.0] * 4), "array.array() must have a size <= 3"),
        (
            ParameterDescriptor,
            "integer_range",
            [IntegerRange()] * 2,
            "field must be a set or sequence with length <= 1 and each value of type 'IntegerRange'",
        ),
        (
            Imu,
            "orientation_covariance",
            [0.0] * 8,
            "field must be a set or sequence with length 9 and each value of type 'float' "
            f"and each double in [-{DOUBLE}, {DOUBLE}]",
        ),
        (Imu, "orientation_covariance", np.zeros(8), "numpy.ndarray() must have a size of 9"),
        (Imu, "orientation_covariance", np.zeros(9, int), "numpy.ndarray() must have the dtype of 'numpy.float64'"),
        (MeshTriangle, "vertex_indices", np.zeros(3), "numpy.ndarray() must have the dtype of 'numpy.uint32'"),
        (
            ByteMultiArray,
            "data",
            b"ab",
            "field must be a set or sequence and each value of type 'bytes'",
        ),
        (Byte, "data", b"ab", "field must be of type 'bytes' or 'ByteString' with length 1"),
        (Byte, "data", 1, "field must be of type 'bytes' or 'ByteString' with length 1"),
        (String, "data", b"a", "field must be of type 'str'"),
        (FieldType, "nested_type_name", "a" * 256, "field must be string value not longer than 255"),
        (ParameterValue, "bool_value", 1, "field must be of type 'bool'"),
        (ParameterValue, "bool_array_value", [1], "field must be a set or sequence and each value of type 'bool'"),
        (Int8, "data", 1.0, "field must be of type 'int'"),
        (Int8, "data", 128, "field must be an integer in [-128, 127]"),
        (UInt8, "data", -1, "field must be an unsigned integer in [0, 255]"),
        (Char, "data", "a", "field must be of type 'int'"),
        (Float64, "data", 1, "field must be of type 'float'"),
        (Float32, "data", 1e39, "field must be a float in [-3.402823466e+38, 3.402823466e+38]"),
    ],
)
def test_checks(cls: Any, field: str, value: Any, problem: str) -> None:
    message = cls(check_fields=True)
    before = repr(message)
    with pytest.raises(AssertionError) as raised:
        setattr(message, field, value)
    assert str(raised.value) == f"The '{field}' {problem}"
    assert repr(message) == before


@pytest.mark.parametrize(
    ("cls", "field", "value"),
    [
        (JointState, "name", {"a"}),
        (JointState, "name", UserList(["a"])),
        (JointState, "position", [math.nan, math.inf, -math.inf]),
        (JointState, "position", [np.float64(1.0)]),
        (Image, "data", b"ab"),
        (Joy, "buttons", [True]),
        (Byte, "data", bytearray(b"a")),
        (FieldType, "nested_type_name", UserString("a" * 255)),
        (Float32, "data", math.nan),
        (Float32, "data", math.inf),
        (Int8, "data", True),
        (Imu, "orientation_covariance", [0.0] * 9),
        (ParameterDescriptor, "integer_range", [IntegerRange()]),
    ],
)
def test_checks_pass(cls: Any, field: str, value: Any) -> None:
    setattr(cls(check_fields=True), field, value)
    cls(check_fields=True, **{field: value})


def test_checked_containers_are_kept_as_they_are() -> None:
    positions, covariance = array("d", [1.0]), np.zeros(9)
    message, imu = JointState(check_fields=True), Imu(check_fields=True)
    message.position, imu.orientation_covariance = positions, covariance
    assert message.position is positions
    assert imu.orientation_covariance is covariance


def test_the_constructor_makes_arrays_before_it_checks() -> None:
    assert JointState(position=[1], check_fields=True).position == array("d", [1.0])
    with pytest.raises(TypeError):
        JointState(position="abc", check_fields=True)


def test_unknown_keywords() -> None:
    with pytest.raises(AssertionError) as raised:
        Header(stamp=Time(), y=1, frame_id="", x=1, check_fields=True)
    assert str(raised.value) == "Invalid arguments passed to constructor: x, y"
    assert Header(x=1) == Header()  # unchecked, they are passed over
    with pytest.raises(TypeError, match="takes 1 positional argument but 2 were given"):
        Header(Time())


def test_the_environment_asks_for_checks(start: Callable[[str], subprocess.Popen[str]]) -> None:
    process = start(
        "import os; os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'\n"
        "from std_msgs.msg import String\n"
        "String(data=3, check_fields=False)\n"
        "String(data=3)"
    )
    assert process.communicate(timeout=60)[1].splitlines()[-1] == (
        "AssertionError: The 'data' field must be of type 'str'"
    )


@pytest.mark.parametrize("package", ["sensor_msgs", "geometry_msgs"])
def test_a_star_imports_all_messages(package: str) -> None:
    names: dict[str, Any] = {}
    exec(f"from {package}.msg import *", names)
    assert {name.split("/")[2] for name in ALL_TYPES if name.startswith(f"{package}/")} <= set(names)


@pytest.mark.parametrize("name", ["Nothing", "JointStat", "jointState"])
def test_a_misspelt_message(name: str) -> None:
    with pytest.raises(ImportError, match=f"cannot import name '{name}' from 'sensor_msgs.msg'"):
        exec(f"from sensor_msgs.msg import {name}")
    with pytest.raises(AttributeError, match=f"module 'sensor_msgs.msg' has no attribute '{name}'"):
        getattr(import_module("sensor_msgs.msg"), name)


def test_what_is_no_message_package() -> None:
    for name in "no_such_msgs.msg", "sensor_msgs.nothing", "sensor_msgs.msg._joint_stat", "sensor_msgs.msg.Joy":
        with pytest.raises(ModuleNotFoundError, match="No module named"):
            import_module(name)


@pytest.mark.embedded
class TestWhatOnlyTheEmbeddedRos2Says:
    """What a real ROS 2 has, and where the embedded one helps more."""

    @pytest.mark.parametrize(
        "name", ["std_srvs.srv", "sensor_msgs.srv", "example_interfaces.action", "example_interfaces.msg"]
    )
    def test_services_and_actions_need_a_real_ros(self, name: str) -> None:
        with pytest.raises(ImportError, match=r"has no (\w|\.)+\. A real ROS 2 Jazzy has: see https"):
            import_module(name)

    def test_the_message_that_is_meant_is_named(self) -> None:
        with pytest.raises(ImportError, match="Did you mean 'JointState'"):
            exec("from sensor_msgs.msg import JointStat")
