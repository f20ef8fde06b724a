"""Bags are read as they were written, by us and by other programs; truncated or damaged ones as far as possible."""

import os
import random
import shutil
import sqlite3
import struct
import tracemalloc
from contextlib import closing
from functools import cache
from io import BytesIO

import pytest
import yaml
from backports import zstd
from lz4 import frame as lz4
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap.writer import Writer
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from tutorial.errors import TutorialError
from tutorial.ros.bags import Bag, BagTopic, bag_info
from tutorial.ros.bags.qos import offered, qos_text
from tutorial.ros.bags.storage import LARGEST_MESSAGE, Channel
from tutorial.ros.bags.writer import BagWriter

START = 1_700_000_000 * 10**9
STEP = 20_000_000  # [ns]
SUFFIXES = {"mcap": ".mcap", "sqlite3": ".db3"}
STRING, JOINTS = "std_msgs/msg/String", "sensor_msgs/msg/JointState"
CHANNELS = (
    Channel("/said", STRING, "cdr", qos_text([QoSProfile(depth=3)]), "string data\n", "RIHS01_1"),
    Channel("/Tank/joint_state", JOINTS, definition="string[] name\n", type_hash="RIHS01_2"),
    Channel("/silent", STRING),
)


def record(opcode, body=b"", size=None):
    """Return a record of an MCAP file: https://mcap.dev/spec."""
    return struct.pack("<BQ", opcode, len(body) if size is None else size) + body


def text(words):
    return struct.pack("<I", len(words)) + words


def chunk(size, packed, compression=b"zstd"):
    body = struct.pack("<QQQI", 0, 2**63, size, 0) + text(compression) + struct.pack("<Q", len(packed)) + packed
    return record(6, body)


MAGIC = b"\x89MCAP0\r\n"
HEADER = MAGIC + record(1, text(b"ros2") + text(b"me"))
BOMB = zstd.compress(bytes(LARGEST_MESSAGE))


@cache  # Fast DDS leaves garbage in the padding
def payload(i: int) -> bytes:
    if i % 2:
        return serialize_message(JointState(name=["TURRET_Y"], position=[i / 10]))
    return serialize_message(String(data=f"number {i}"))


def messages(count: int) -> list[tuple[str, int, bytes]]:
    return [(CHANNELS[i % 2].topic, START + i * STEP, payload(i)) for i in range(count)]


def write(path, storage="mcap", killed=None, **how) -> list[tuple[str, int, bytes]]:
    """Write a bag of 100 messages, and a copy as a killed recording would leave it."""
    writer = BagWriter(path, storage, **how)
    for channel in CHANNELS:
        writer.add_channel(channel)
    for i, (topic, time, data) in enumerate(messages(100)):
        writer.write(topic, time, time - 1000, data)
        if i % 30 == 29:
            writer.flush()
    if killed is not None:
        shutil.copytree(path, killed)
    writer.close()
    return messages(100)


def make(path, *payloads, channels=CHANNELS[:1], storage="mcap") -> Bag:
    """Write a bag with messages on its first channel."""
    writer = BagWriter(path, storage)
    for channel in channels:
        writer.add_channel(channel)
    for data in payloads:
        writer.write(channels[0].topic, START, START, data)
    writer.close()
    return Bag(path)


def read(path) -> tuple[list[tuple[str, int, bytes]], str]:
    """Return the messages of a damaged bag and the report of the damage, or no messages and the error."""
    try:
        bag = Bag(path)
        found = list(bag.raw_messages())
        assert bag_info(bag).replace("\n", "").isprintable()
        return found, bag.damage
    except TutorialError as error:
        return [], str(error)


@pytest.fixture(params=SUFFIXES)
def storage(request):
    return request.param


def test_a_bag_is_read_as_it_was_written(tmp_path, storage):
    written = write(tmp_path / "bag", storage=storage)
    bag = Bag(tmp_path / "bag")
    assert bag.topics == [
        BagTopic("/Tank/joint_state", JOINTS, 50),
        BagTopic("/said", STRING, 50),
        BagTopic("/silent", STRING, 0),
    ]
    assert (bag.start, bag.duration, bag.damage, bag.storage, bag.distro) == (START, 1.98, "", storage, "jazzy")
    assert list(bag.raw_messages()) == written
    assert [message.data for *_, message in bag.messages(["/said"])] == [f"number {i}" for i in range(0, 100, 2)]
    assert list(bag.raw_messages(start_offset=1.0)) == written[50:]
    assert bag.channel("/said").qos == CHANNELS[0].qos
    assert read(bag.files[0]) == (written, ""), "one file is a bag, too"


def test_rosbags_reads_it(tmp_path, storage):
    written = write(tmp_path / "bag", storage=storage)
    with Reader(tmp_path / "bag") as reader:
        assert [(connection.topic, time, data) for connection, time, data in reader.messages()] == written
        said = next(connection for connection in reader.connections if connection.topic == "/said")
        assert (said.msgtype, said.digest, said.msgcount) == (STRING, "RIHS01_1", 50)
        assert said.msgdef.data == "string data\n"
        since = START + 70 * STEP  # uses the index
        found = [(time, data) for _, time, data in reader.messages([said], start=since)]
        assert found == [(time, data) for topic, time, data in written[70:] if topic == "/said"]


def test_the_mcap_package_reads_it(tmp_path):
    """It reads when each message was sent, and finds no damage."""
    written = write(tmp_path / "bag")
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as file:
        found = [(message.log_time, message.publish_time) for *_, message in make_reader(file, True).iter_messages()]
    assert found == [(time, time - 1000) for _, time, _ in written]


def test_after_the_longest_duration_a_new_file_begins(tmp_path, storage):
    written = write(tmp_path / "bag", storage=storage, max_duration=0.5)
    bag = Bag(tmp_path / "bag")
    assert [file.name for file in bag.files] == [f"bag_{i}{SUFFIXES[storage]}" for i in range(4)]
    assert list(bag.raw_messages()) == written
    told = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert [file["message_count"] for file in told["files"]] == [25, 25, 25, 25]
    assert told["duration"]["nanoseconds"] == 99 * STEP
    (tmp_path / "bag" / f"bag_2{SUFFIXES[storage]}").unlink()
    found, damage = read(tmp_path / "bag")
    assert "metadata.yaml lists 100 messages, but the bag has 75" in damage
    assert found == written[:50] + written[75:]


def test_nothing_is_overwritten(tmp_path):
    (tmp_path / "bag").mkdir()
    with pytest.raises(TutorialError, match="a recording never overwrites files"):
        BagWriter(tmp_path / "bag")
    assert list((tmp_path / "bag").iterdir()) == []
    with pytest.raises(TutorialError, match="is not UTF-8"):
        BagWriter(tmp_path / "bad\udcff")
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def test_a_killed_recording_is_read_up_to_its_last_flush(tmp_path, storage):
    written = write(tmp_path / "whole", storage, killed=tmp_path / "bag")
    bag = Bag(tmp_path / "bag")
    assert list(bag.raw_messages()) == written[:90]
    assert sum(topic.count for topic in bag.topics) == 90
    assert "metadata.yaml is missing, as happens if the recorder is killed" in bag.damage


def test_a_truncated_file_is_read_as_far_as_possible(tmp_path, storage):
    written = write(tmp_path / "bag", storage=storage)
    path = tmp_path / "bag" / f"bag_0{SUFFIXES[storage]}"
    whole = path.read_bytes()
    counts = []
    for size in [*range(0, len(whole), 997), len(whole) - 100, len(whole) - 1]:
        path.write_bytes(whole[:size])
        found, damage = read(tmp_path / "bag")
        assert damage
        if "its last page is incomplete" in damage:  # SQLite reads zeros there
            assert len(set(found) - set(written)) <= 2
        else:
            assert found == written[: len(found)]
        counts.append(len(found))
    assert counts == sorted(counts)
    assert len(set(counts)) > (8 if storage == "mcap" else 1)  # SQLite writes pages, and not in order
    assert counts[-1] >= 90


@pytest.mark.parametrize(("name", "pack"), [(b"zstd", zstd.compress), (b"lz4", lz4.compress)], ids=["zstd", "lz4"])
def test_a_compressed_chunk_is_read_whole_and_in_part(tmp_path, name, pack):
    written = write(tmp_path / "bag")
    reader = StreamReader(BytesIO((tmp_path / "bag" / "bag_0.mcap").read_bytes()), emit_chunks=True)
    records = b"".join(record.data for record in reader.records if isinstance(record, Chunk))
    whole = HEADER + chunk(1000, b"x", b"rar") + chunk(len(records), pack(records), name)
    (tmp_path / "x.mcap").write_bytes(whole)
    found, damage = read(tmp_path / "x.mcap")
    assert found == written
    assert "compressed with 'rar'" in damage, "and reading goes on after that chunk"
    (tmp_path / "x.mcap").write_bytes(whole[:-20])
    found, damage = read(tmp_path / "x.mcap")
    assert found == written[: len(found)]
    assert "a chunk in it is incomplete" in damage


def test_damaged_bytes_give_at_worst_a_clear_error(tmp_path, storage):
    write(tmp_path / "bag", storage=storage)
    path = tmp_path / "bag" / f"bag_0{SUFFIXES[storage]}"
    whole = path.read_bytes()
    chance = random.Random(1)
    count = 0
    for _ in range(150):
        spoilt = bytearray(whole)
        for _ in range(chance.choice((1, 3, 30))):
            spoilt[chance.randrange(len(spoilt))] = chance.choice((0, 1, 0x7F, 0xFF, chance.randrange(256)))
        path.write_bytes(spoilt)
        found, said = read(path)
        count += len(found)
        assert said.isprintable()
    assert count > 1000


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "it is empty"),
        (b"\x00\x01 anything", "it begins with '00 01 20 61 6e 79 74 68', unlike an MCAP file"),
        (HEADER + record(5, size=2**62), "bytes; at most"),
        (HEADER + record(0x7E, size=2**62), "in the middle of a record"),
        (HEADER + chunk(2**62, b""), "bytes; at most"),
        (HEADER + 200 * chunk(1000, BOMB), "end is missing"),
        (HEADER + chunk(1000, b"no zstd at all"), "cannot be unpacked"),
        (HEADER + chunk(1000, b"x", b"rar\x1b"), r"compressed with 'rar\x1b'"),
        (HEADER + record(4, b"\1\0\1\0\xff\xff\xff\xff/a"), "a record in it cannot be read"),
    ],
    ids=lambda value: "" if isinstance(value, bytes) else value,
)
def test_a_hostile_mcap_file_takes_no_memory(tmp_path, data, said):
    path = tmp_path / "x.mcap"
    path.write_bytes(data)
    tracemalloc.start()
    found, damage = read(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found == []
    assert said in damage
    assert peak < 2_000_000


TABLES = """
    CREATE TABLE topics(id, name, type, serialization_format, offered_qos_profiles);
    CREATE TABLE messages(id, topic_id, timestamp, data);
    INSERT INTO topics VALUES (1, x'1b5b324a', x'ff', '', '');
"""
ENDLESS = """CREATE VIEW messages AS
    WITH RECURSIVE count(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM count)
    SELECT id, 1 AS topic_id, id AS timestamp, x'00' AS data FROM count;
"""


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("CREATE TABLE x(y)", "no such table: topics"),
        (
            f"{TABLES}INSERT INTO messages VALUES (1, 1, 'now', 2), (2, 1, -5, 2), (3, 7, 0, x'00')",
            "a row in it is not a message",
        ),
        (f"{TABLES}DROP TABLE messages; {ENDLESS}", "not authorized"),
        (f"{TABLES}INSERT INTO messages VALUES (1, 1, 0, zeroblob({2**27 + 1}))", "string or blob too big"),
    ],
)
def test_a_hostile_database_is_a_clear_error(tmp_path, script, said):
    with closing(sqlite3.connect(tmp_path / "x.db3")) as database:
        database.executescript(script)
    assert said in read(tmp_path / "x.db3")[1]


def test_names_in_a_bag_are_escaped(tmp_path):
    channel = Channel("/\x1b[2Jx", "a\n/b\u202e", encoding="c\td")
    bag = make(tmp_path / "bag", b"\0\1\0\0", channels=[channel])
    said = r"Topic: /\x1b[2Jx | Type: a\n/b\u202e | Count: 1 | Serialization Format: c\td"
    assert said in bag_info(bag)
    with pytest.raises(TutorialError, match=r"The message type .* is invalid"):
        list(bag.messages(["/\x1b[2Jx"]))
    with pytest.raises(TutorialError, match=r"there is no topic '/x' in this bag"):
        list(bag.messages(["/x"]))


def test_an_unknown_type_matters_only_if_it_has_messages(tmp_path):
    bag = make(tmp_path / "bag", payload(0), channels=(CHANNELS[0], Channel("/alien", "alien_msgs/msg/X")))
    assert [message.data for *_, message in bag.messages()] == ["number 0"]


@pytest.mark.parametrize(
    ("channel", "said"),
    [
        (Channel("/alien", "alien_msgs/msg/X"), "The message type 'alien_msgs/msg/X' is invalid"),
        (Channel("/alien", STRING, encoding="json"), "the messages on /alien are 'json', not 'cdr'"),
    ],
    ids=["type", "encoding"],
)
def test_unreadable_topic_is_left_out(tmp_path, caplog, channel, said):
    writer = BagWriter(tmp_path / "bag")
    for each in (channel, CHANNELS[0]):
        writer.add_channel(each)
        writer.write(each.topic, START, START, payload(0))
    writer.close()
    bag = Bag(tmp_path / "bag")
    assert [message.data for *_, message in bag.messages()] == ["number 0"]
    assert caplog.messages == [f"topic /alien is skipped: {said}"]
    with pytest.raises(TutorialError, match=said):
        list(bag.messages(["/alien"]))


def test_compressed_messages(tmp_path, storage, monkeypatch):
    monkeypatch.setattr("tutorial.ros.bags.bag.LARGEST_MESSAGE", 100)
    too_large, cut, empty = zstd.compress(bytes(101)), zstd.compress(payload(1))[:-3], zstd.compress(b"")
    bag = make(tmp_path / "bag", zstd.compress(payload(0)), too_large, cut, empty, payload(2), storage=storage)
    assert [message.data for *_, message in bag.messages()] == ["number 0", "number 2"]
    assert "a message on /said cannot be unpacked: it is incomplete, or too large" in bag.damage
    assert "a message on /said is empty" in bag.damage


def test_an_invalid_message_is_left_out_and_reported(tmp_path):
    bag = make(tmp_path / "bag", b"", b"\0\1\0\0\xff\xff\xff\xff", payload(0))
    assert [message.data for *_, message in bag.messages()] == ["number 0"]
    assert "a message on /said is empty" in bag.damage
    assert "a message on /said cannot be decoded" in bag.damage


def test_messages_are_read_in_the_order_of_time(tmp_path, storage):
    """A writer with several threads may write a message a little late, even in the next chunk."""
    writer = BagWriter(tmp_path / "bag", storage)
    writer.add_channel(CHANNELS[0])
    for i in (0, 1, 2, 3, 5, 4, *range(6, 20)):
        writer.write("/said", START + i, START + i, payload(0))
        if i == 5:
            writer.flush()
    writer.close()
    assert [time - START for _, time, _ in Bag(tmp_path / "bag").raw_messages()] == list(range(20))


MERGED = "a0: &a0 {x: 1}\n" + "".join(f"a{i + 1}: &a{i + 1} {{<<: [{f'*a{i}, ' * 9}]}}\n" for i in range(20))
HUGE = f"rosbag2_bagfile_information: {{version: 0x{'f' * 5000}}}"
SPOILT = [
    "",
    "a: [",
    "[" * 200_000,
    MERGED,
    HUGE,
]


@pytest.mark.parametrize("spoilt", SPOILT, ids=lambda text: text[:10])
def test_invalid_metadata_are_damage(tmp_path, spoilt):
    written = write(tmp_path / "bag")
    (tmp_path / "bag" / "metadata.yaml").write_text(spoilt)
    found, damage = read(tmp_path / "bag")
    assert "metadata.yaml: " in damage
    assert found == written


def test_metadata_that_are_not_a_file_count_as_missing(tmp_path):
    written = write(tmp_path / "bag")
    (tmp_path / "bag" / "metadata.yaml").unlink()
    os.mkfifo(tmp_path / "bag" / "metadata.yaml")
    assert read(tmp_path / "bag")[0] == written


def test_compressed_files(tmp_path):
    written = write(tmp_path / "bag")
    path = tmp_path / "bag" / "metadata.yaml"
    path.write_text(path.read_text().replace("compression_mode: ''", "compression_mode: FILE"))
    (file,) = Bag(tmp_path / "bag").files
    packed = file.with_suffix(".mcap.zstd")
    packed.write_bytes(zstd.compress(file.read_bytes()))
    assert read(tmp_path / "bag")[0] == written, "the unpacked file is beside the compressed one"
    file.unlink()
    with pytest.raises(TutorialError, match=f"the files of the bag .* are compressed. .*zstd -d {packed.name} -o "):
        Bag(tmp_path / "bag")


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("nowhere", "there is no bag"),
        ("empty", r"it has no \.mcap or \.db3 file\.$"),
        ("old", r"it has no \.mcap or \.db3 file\. 'old/x\.bag': it is a ROS 1 bag"),
        ("x", "'x' is not a bag: it is neither"),
    ],
)
def test_a_path_without_a_bag_is_a_clear_error(tmp_path, monkeypatch, path, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x").write_bytes(b"\0\1\2")
    (tmp_path / "empty").mkdir()
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "x.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(TutorialError, match=said):
        Bag(path)


LFS = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 10\n"
FOREIGN = [
    ("x.mcap", LFS, "git lfs pull"),
    ("x.db3", LFS, "git lfs pull"),
    ("old 1.bag", b"#ROSBAG V2.0\n\x45\0", "rosbags-convert --src 'old 1.bag' --dst 'old 1'"),
    ("older.bag", b"#ROSRECORD V1.1\n", "it is a ROS 1 bag"),
    ("x.mcap.zstd", zstd.compress(b"x"), "zstd -d x.mcap.zstd -o x.mcap"),
    ("x.db3", zstd.compress(b"x"), "zstd -d x.db3 -o x"),
    ("x.mcap.lz4", lz4.compress(b"x"), "it is compressed with lz4"),
    ("x.mcap.gz", b"\x1f\x8b\x08", "it is compressed with gzip"),
    ("x.zip", b"PK\x03\x04", "it is a zip archive"),
    ("x.tar", b"x.mcap".ljust(257, b"\0") + b"ustar", "it is a tar archive"),
    ("x.mcap", b"", "it is empty"),
    ("x.db3", b"<!DOCTYPE html>\n<html>", "it is a web page"),
    ("x.mcap", "tür\n".encode() * 500, "it is a text file"),
    ("metadata.yaml", b"rosbag2_bagfile_information:\n", "Give the folder"),
]


@pytest.mark.parametrize(("name", "data", "said"), FOREIGN, ids=[f"{name} {said}" for name, _, said in FOREIGN])
def test_foreign_file(tmp_path, name, data, said):
    (tmp_path / name).write_bytes(data)
    assert said in read(tmp_path / name)[1]


def test_folder_of_lfs_pointers(tmp_path):
    write(tmp_path / "bag")
    (tmp_path / "bag" / "bag_0.mcap").write_bytes(LFS)
    assert "can be read: bag_0.mcap: it is a Git LFS pointer" in read(tmp_path / "bag")[1]


@pytest.mark.parametrize("name", ["x", "x.db3", "x.mcap"])
def test_kind_by_content(tmp_path, storage, name):
    written = write(tmp_path / "bag", storage)
    path = (tmp_path / "bag" / f"bag_0{SUFFIXES[storage]}").rename(tmp_path / name)
    assert (Bag(path).storage, read(path)) == (storage, (written, ""))


@pytest.mark.parametrize("profile", ["", "x", "ros2"])
def test_mcap_profiles(tmp_path, profile):
    with (tmp_path / "x.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start(profile)
        schema = writer.register_schema(STRING, "ros2msg", b"string data")
        writer.add_message(writer.register_channel("/said", "cdr", schema), START, payload(0), START)
        writer.finish()
    bag = Bag(tmp_path / "x.mcap")
    assert ([message.data for *_, message in bag.messages()], bag.damage) == (["number 0"], "")


def test_refuses_other_encodings(tmp_path):
    bag = make(tmp_path / "bag", b"{'data': 1}", channels=[Channel("/said", STRING, encoding="json")])
    with pytest.raises(TutorialError, match="the messages on /said are 'json', not 'cdr'"):
        list(bag.messages(["/said"]))


def test_short_type_name(tmp_path):
    bag = make(tmp_path / "bag", payload(0), channels=[Channel("/said", "std_msgs/String")])
    assert bag.topics == [BagTopic("/said", "std_msgs/String", 1)]
    assert [message.data for *_, message in bag.messages()] == ["number 0"]


def test_optional_slash(tmp_path):
    bag = make(tmp_path / "bag", payload(0), channels=[Channel("said", STRING), Channel("/x", STRING)])
    assert [[name for name, *_ in bag.messages([topic])] for topic in ("said", "/said")] == [["said"], ["said"]]
    assert bag.channel("x").topic == "/x"


OLD = ["id, name, type", "id, name, type, serialization_format", "type, id, name, extra, offered_qos_profiles"]


def old(path, columns, how=""):
    """Write an SQLite file like an older ros2 bag."""
    values = {"id": "1", "name": "'/said'", "type": f"'{STRING}'", "serialization_format": "'cdr'"}
    words = ", ".join(values.get(name, "''") for name in columns.split(", "))
    with closing(sqlite3.connect(path)) as database:
        database.executescript(
            f"{how}; CREATE TABLE topics({columns}); INSERT INTO topics VALUES ({words});"
            "CREATE TABLE messages(id, topic_id, timestamp, data);"
        )
        database.execute("INSERT INTO messages VALUES (1, 1, ?, ?)", (START, payload(0)))
        database.commit()


@pytest.mark.parametrize("columns", OLD)
def test_old_columns(tmp_path, columns):
    old(tmp_path / "x.db3", columns)
    bag = Bag(tmp_path / "x.db3")
    assert ([message.data for *_, message in bag.messages()], bag.damage) == (["number 0"], "")
    assert (bag.channel("/said").encoding, bag.channel("/said").qos) == ("cdr", "")


def test_read_only_folder(tmp_path):
    """SQLite cannot create its -wal file in a read-only folder. Here a folder with that name has the same effect."""
    old(tmp_path / "x.db3", OLD[1], "PRAGMA journal_mode=WAL")
    (tmp_path / "x.db3-wal").mkdir()
    assert read(tmp_path / "x.db3") == ([("/said", START, payload(0))], "")
    (tmp_path / "x.db3-journal").write_bytes(b"x")
    assert "its last transaction is incomplete" in read(tmp_path / "x.db3")[1]


def test_quality_of_service_survives_a_bag():
    policies = {"reliability": ReliabilityPolicy.BEST_EFFORT, "durability": DurabilityPolicy.TRANSIENT_LOCAL}
    profile = QoSProfile(depth=7, lifespan=Duration(seconds=10), **policies)
    found = offered(qos_text([profile, profile]))
    assert {name: getattr(found, name) for name in policies} == policies
    assert (found.lifespan, found.deadline, found.depth) == (Duration(seconds=10), Duration(), 10)


DEFAULT = (10, ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)
LATCHED = (10, ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.TRANSIENT_LOCAL)
FOREVER = "{sec: 9223372036, nsec: 854775807}"
OLDER = (
    f"- {{history: 1, depth: 5, reliability: 2, durability: 1, deadline: {FOREVER}, lifespan: {FOREVER}, liveliness: 1,"
    f" liveliness_lease_duration: {FOREVER}, avoid_ros_namespace_conventions: false}}"
)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", DEFAULT),
        ("- {reliability: 9, deadline: {sec: x}}", DEFAULT),
        (qos_text([QoSProfile(depth=1), QoSProfile(depth=2)]), DEFAULT),
        (OLDER, LATCHED),
        pytest.param("\n".join([OLDER] * 200), LATCHED, id="200 publishers"),
    ],
)
def test_unknown_or_mixed_profiles_become_the_default_and_numbers_are_read(text, said):
    found = offered(text)
    assert (found.depth, found.reliability, found.durability) == said
    assert found.deadline == Duration()
