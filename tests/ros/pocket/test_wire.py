"""Messages to bytes and back: the bytes of a real ROS 2, and invalid bytes."""

import json
import tracemalloc
from contextlib import suppress
from pathlib import Path

import pytest
import rclpy
from hypothesis import given
from hypothesis import strategies as st
from message_types import message_class
from rclpy.serialization import deserialize_message, serialize_message
from rmw_dds_common.msg import NodeEntitiesInfo
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import Image, Imu, JointState, Joy
from std_msgs.msg import ByteMultiArray, Empty, Int8, String, UInt8MultiArray
from unique_identifier_msgs.msg import UUID

GOLDEN = json.loads((Path(__file__).parent / "data/golden_cdr.json").read_text())
LITTLE_ENDIAN = b"\0\1\0\0"
MILLION = (2**20).to_bytes(4, "little")  # as a length: more than there is, but less than the computer's memory
BILLIONS = b"\xff\xff\xff\xff"  # as a length: the largest

each_sample = pytest.mark.parametrize("sample", GOLDEN["samples"], ids=lambda sample: sample["label"])


@pytest.mark.skipif(
    rclpy.get_rmw_implementation_identifier() == "rmw_fastrtps_cpp", reason="this RMW leaves garbage in the padding"
)
@each_sample
def test_recorded_bytes(sample):
    recorded = bytes.fromhex(sample["cdr_hex"])
    assert serialize_message(deserialize_message(recorded, message_class(sample["type"]))) == recorded


@each_sample
def test_recorded_values_in_any_byte_order_and_with_any_padding(sample):
    store, name = get_typestore(Stores.ROS2_JAZZY), sample["type"]
    little, padded = (bytes.fromhex(sample[key]) for key in ("cdr_hex", "cdr_hex_fastrtps"))
    big = store.serialize_cdr(store.deserialize_cdr(little, name), name, little_endian=False)
    received = [repr(deserialize_message(data, message_class(name))) for data in (little, padded, bytes(big))]
    assert received == [sample["repr"]] * 3


@pytest.mark.parametrize("type_name", GOLDEN["fields"])
def test_recorded_field_types(type_name):
    assert message_class(type_name).get_fields_and_field_types() == GOLDEN["fields"][type_name]


@pytest.mark.pocket
@pytest.mark.parametrize("type_name", GOLDEN["type_hashes"])
def test_recorded_type_hashes(type_name):
    from _rosidl.definitions import type_hash

    assert type_hash(type_name) == GOLDEN["type_hashes"][type_name]


@pytest.mark.pocket
def test_recorded_type_names():
    from rclpy._wire import wire_name

    assert {s["type"]: wire_name(s["type"]) for s in GOLDEN["samples"]} == {
        s["type"]: s["dds_type"] for s in GOLDEN["samples"]
    }


@pytest.mark.pocket
@pytest.mark.parametrize(
    ("cls", "field", "value", "member"),
    [
        (String, "data", 3, "data"),
        (Int8, "data", 128, "data"),
        (JointState, "name", [1], "name"),
        (JointState, "header", None, "header"),
        (Imu, "orientation_covariance", [0.0] * 8, "orientation_covariance"),
        (UUID, "uuid", [0] * 15, "_uuid_octets"),
    ],
)
def test_a_wrong_value_names_its_field(cls, field, value, member):
    message = cls()
    setattr(message, field, value)
    kind = AttributeError if field == "header" else TypeError  # as in rclpy for an argument that is not a message
    with pytest.raises(kind, match=f"{cls.__name__} cannot be serialized: Failed to encode member {member}"):
        serialize_message(message)


@pytest.mark.pocket
@pytest.mark.parametrize(
    ("data", "cls"),
    [
        (b"", String),
        (LITTLE_ENDIAN, Empty),
        (LITTLE_ENDIAN + b"\xff\xff", JointState),
        (LITTLE_ENDIAN + b"\5\0\0\0ab", String),
        (LITTLE_ENDIAN + MILLION, String),
        (LITTLE_ENDIAN + bytes(8) + MILLION, UInt8MultiArray),
        (LITTLE_ENDIAN + bytes(8) + MILLION, ByteMultiArray),
        (LITTLE_ENDIAN + 2 * b"\1\0\0\0\0\0\0\0" + MILLION, NodeEntitiesInfo),
        (LITTLE_ENDIAN + bytes(8) + b"\1\0\0\0\0\0\0\0\0\0\0\0" + BILLIONS, JointState),
        (b"\0\0\0\0" + bytes(8) + BILLIONS, UInt8MultiArray),
        (LITTLE_ENDIAN + b"\2\0\0\0ab", String),
        (LITTLE_ENDIAN + b"\3\0\0\0\xff\xfe\0", String),
        (serialize_message(UUID())[:-1], UUID),
        (serialize_message(Image(data=bytes(100)))[:-99], Image),
    ],
    ids=lambda value: f"{len(value)} bytes" if isinstance(value, bytes) else value.__name__,
)
def test_invalid_bytes_are_refused(data, cls):
    with pytest.raises(RuntimeError, match=f"^failed to deserialize .*: {len(data)} bytes are not a {cls.__name__}: ."):
        deserialize_message(data, cls)


@pytest.mark.pocket
@pytest.mark.parametrize("cls", [String, UInt8MultiArray, ByteMultiArray, JointState, Image])
def test_a_length_allocates_nothing_before_its_data_exists(cls):
    data = LITTLE_ENDIAN + BILLIONS * 1000 if cls is String else LITTLE_ENDIAN + bytes(8) + BILLIONS * 1000
    for _ in range(2):  # the first call also creates the decoder, and imports
        tracemalloc.start()
        with pytest.raises(RuntimeError, match="are not a "):
            deserialize_message(data, cls)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert most < 20_000


@pytest.mark.pocket
@given(
    st.sampled_from([JointState, Joy, Image, ByteMultiArray, NodeEntitiesInfo]),
    st.one_of(st.binary(max_size=64), st.binary(max_size=64).map(LITTLE_ENDIAN.__add__)),
)
def test_any_bytes_are_a_message_or_refused(cls, data):
    with suppress(RuntimeError):
        message = deserialize_message(data, cls)
        assert type(message) is cls
        assert len(serialize_message(message)) <= 2 * len(data) + 16  # no message is larger than its bytes justify
