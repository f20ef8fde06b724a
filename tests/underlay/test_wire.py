"""Messages to bytes and back: the bytes of a real ROS 2, and every message type there is."""

from __future__ import annotations

import json
import math
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from _rosidl.definitions import Cardinality, Field, definition, type_hash, type_names
from _rosidl.message import Message, message_class
from _rosidl.values import PRIMITIVES
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image, JointState
from std_msgs.msg import String

GOLDEN = json.loads((Path(__file__).parent / "data/golden_cdr.json").read_text())
ALL_TYPES = [f"{package}/msg/{name}" for package, names in type_names().items() for name in names]


def fill(message: Any, values: dict[str, Any]) -> Any:
    """Set fields from plain values, in which infinities and NaN are strings."""
    types = message.get_fields_and_field_types()
    for name, value in values.items():
        current = getattr(message, name)
        if isinstance(value, dict):
            fill(current, value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            package, _, element = types[name].removeprefix("sequence<").rstrip(">").partition("/")
            setattr(
                message,
                name,
                [fill(getattr(import_module(f"{package}.msg"), element)(), item) for item in value],
            )
        elif isinstance(value, list) and not types[name].startswith("sequence<string"):
            setattr(message, name, [float(item) if isinstance(item, str) else item for item in value])
        else:
            setattr(
                message,
                name,
                float(value) if isinstance(value, str) and types[name] in ("double", "float") else value,
            )
    return message


@pytest.mark.parametrize("sample", GOLDEN["samples"], ids=lambda sample: sample["label"])
def test_golden_bytes(sample: dict[str, Any]) -> None:
    cls = message_class(sample["type"])
    recorded = bytes.fromhex(sample["cdr_hex"])
    message = fill(cls(), sample["value"])
    assert serialize_message(message).hex() == recorded.hex()
    assert serialize_message(deserialize_message(recorded, cls)) == recorded


@pytest.mark.parametrize(
    "sample", [s for s in GOLDEN["samples"] if s.get("cdr_hex_fastrtps")], ids=lambda s: s["label"]
)
def test_padding_and_tail_are_ignored(sample: dict[str, Any]) -> None:
    cls = message_class(sample["type"])
    decoded = deserialize_message(bytes.fromhex(sample["cdr_hex_fastrtps"]), cls)
    assert serialize_message(decoded).hex() == sample["cdr_hex"]


@pytest.mark.parametrize("type_name", GOLDEN["type_hashes"])
def test_type_hashes(type_name: str) -> None:
    assert type_hash(type_name) == GOLDEN["type_hashes"][type_name]


@pytest.mark.parametrize("type_name", GOLDEN["fields"])
def test_field_types(type_name: str) -> None:
    assert message_class(type_name).get_fields_and_field_types() == GOLDEN["fields"][type_name]


def value_of(field: Field) -> st.SearchStrategy[Any]:
    """Any value that the field can hold."""
    if field.is_message:
        one: st.SearchStrategy[Any] = st.deferred(lambda: message_of(field.base))
    else:
        primitive = PRIMITIVES[field.base]
        one = {
            bool: st.booleans(),
            bytes: st.binary(min_size=1, max_size=1),
            str: st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=field.string_bound or 8),
            int: st.integers(*map(int, primitive.limits)),
            float: st.floats(width=32 if field.base == "float32" else 64, allow_nan=False),
        }[primitive.python]
    if field.cardinality is Cardinality.ARRAY:
        return st.lists(one, min_size=field.size, max_size=field.size)
    if field.cardinality is Cardinality.SEQUENCE:
        return st.lists(one, max_size=min(field.size or 2, 2))
    return one


def message_of(type_name: str) -> st.SearchStrategy[Message]:
    """Any message of a type."""
    return st.builds(
        message_class(type_name), **{field.name: value_of(field) for field in definition(type_name).fields}
    )


@pytest.mark.parametrize("type_name", ALL_TYPES)
def test_default_message_round_trip(type_name: str) -> None:
    message = message_class(type_name)()
    assert deserialize_message(serialize_message(message), type(message)) == message


@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_any_message_round_trip(data: st.DataObject) -> None:
    message = data.draw(message_of(data.draw(st.sampled_from(ALL_TYPES))))
    received = deserialize_message(serialize_message(message), type(message))
    assert received == message
    assert repr(received) == repr(message)


def test_types_of_containers_survive() -> None:
    image = Image(data=bytes(range(256)))
    received = deserialize_message(serialize_message(image), Image)
    assert received.data.typecode == "B"
    assert received.data.tobytes() == bytes(range(256))


def test_not_a_number_survives() -> None:
    received = deserialize_message(serialize_message(JointState(position=[math.nan, math.inf])), JointState)
    assert math.isnan(received.position[0])
    assert received.position[1] == math.inf


def test_wrong_value_names_the_field() -> None:
    with pytest.raises(TypeError, match="String cannot be serialized: Failed to encode member data"):
        serialize_message(String(data=3))


def test_garbage_is_refused() -> None:
    with pytest.raises(RuntimeError, match="6 bytes are no JointState"):
        deserialize_message(b"\0\1\0\0\xff\xff", JointState)
