"""Message classes behave like those that ROS 2 generates: their fields, conversions, checks and texts."""

import copy
import pickle
import re
from array import array
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from message_types import message_class
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import Stores, get_typestore

ALL_TYPES = sorted(get_typestore(Stores.ROS2_JAZZY).fielddefs)
NUMBER_CODES = {"float": "f", "double": "d"} | {
    f"{sign}int{bits}": code.upper() if sign else code
    for bits, code in ((8, "b"), (16, "h"), (32, "i"), (64, "q"))
    for sign in ("", "u")
}


def parts(field_type: str) -> tuple[str, str, int]:
    """Split ``"sequence<double, 3>"`` into ``("double", "sequence", 3)``."""
    if several := re.fullmatch(r"sequence<(.*?)(?:, (\d+))?>", field_type):
        return several[1], "sequence", int(several[2] or 0)
    if several := re.fullmatch(r"(.*)\[(\d+)\]", field_type):
        return several[1], "array", int(several[2])
    return field_type, "", 0


def is_default(value: Any, field_type: str) -> bool:
    """Return whether a value is the default of a field's type."""
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
def test_every_type_has_topics(package, node):
    for type_name in (name for name in ALL_TYPES if name.startswith(f"{package}/")):
        cls = message_class(type_name)
        publisher = node.create_publisher(cls, f"topic_of_{cls.__name__}", 1)
        publisher.publish(cls())
        node.destroy_publisher(publisher)


@pytest.mark.parametrize("type_name", ALL_TYPES)
def test_every_type(type_name):
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
    """Return a class's module: ``_joint_state`` for ``JointState``, ``_color_rgba`` for ``ColorRGBA``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=.)(?=[A-Z][a-z])", "_", name).lower()


def carried(message: Any) -> Any:
    """Serialize and deserialize a message."""
    return deserialize_message(serialize_message(message), type(message))


def values(field_type: str) -> st.SearchStrategy[Any]:
    """Generate any value that a field of a type can hold."""
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
    """Generate any message of a type."""
    cls = message_class(type_name)
    return st.builds(cls, **{name: values(kind) for name, kind in cls.get_fields_and_field_types().items()})


@settings(max_examples=200, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_any_message_survives_serialization(data):
    message = data.draw(messages(data.draw(st.sampled_from(ALL_TYPES))))
    assert carried(message) == message
    assert repr(carried(message)) == repr(message)


@pytest.mark.process
def test_the_environment_can_enable_checks(start):
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
def test_a_star_imports_all_messages(package):
    names: dict[str, Any] = {}
    exec(f"from {package}.msg import *", names)
    assert {name.split("/")[2] for name in ALL_TYPES if name.startswith(f"{package}/")} <= set(names)


@pytest.mark.pocket
class TestPocketOnlyErrors:
    """Errors that are more helpful than those of a real ROS 2."""

    @pytest.mark.parametrize(
        "name", ["std_srvs.srv", "sensor_msgs.srv", "example_interfaces.action", "example_interfaces.msg"]
    )
    def test_services_and_actions_need_a_real_ros(self, name):
        with pytest.raises(ImportError, match=r"has no (\w|\.)+\. Install a real ROS 2 Jazzy \(see https"):
            import_module(name)

    def test_the_nearest_message_is_suggested(self):
        with pytest.raises(ImportError, match="Did you mean 'JointState'"):
            exec("from sensor_msgs.msg import JointStat")
