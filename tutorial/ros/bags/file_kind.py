"""Identify a file by its first bytes: a bag file, or another kind of file that users often pass by mistake."""

import shlex
from pathlib import Path

from tutorial.errors import printable

HEAD = 512  # number of bytes to read, enough for every kind
SUFFIXES = {b"\x89MCAP0\r\n": ".mcap", b"SQLite format 3\0": ".db3"}
"""The first bytes of each kind of bag file, and the usual suffix of the file's name."""

ROS_1 = "it is a ROS 1 bag. Convert it to ROS 2: rosbags-convert --src {name} --dst {stem}"
FOREIGN = {
    b"version https://git-lfs.github.com/": (
        "it is a Git LFS pointer, not the file itself. Download the file: git lfs pull"
    ),
    b"#ROSBAG V": ROS_1,
    b"#ROSRECORD V": ROS_1,
    b"rosbag2_bagfile_information:": "it is a bag's metadata. Give the folder that contains it",
    b"\x28\xb5\x2f\xfd": "it is compressed with zstd. Unpack it first: zstd -d {name} -o {stem}",
    b"\x1f\x8b": "it is compressed with gzip. Unpack it first",
    b"\x04\x22\x4d\x18": "it is compressed with lz4. Unpack it first",
    b"\xfd7zXZ\0": "it is compressed with xz. Unpack it first",
    b"BZh": "it is compressed with bzip2. Unpack it first",
    b"PK\x03\x04": "it is a zip archive. Unpack it first",
    b"7z\xbc\xaf\x27\x1c": "it is a 7z archive. Unpack it first",
}
"""The first bytes of other kinds of files, what each file is, and what to do with it."""

UNKNOWN = "it is neither an MCAP file nor an SQLite file"
TAR_AT, TAR = 257, b"ustar"
WEB_PAGE = ("<!doctype html", "<html")


def suffix_of(path: Path) -> str:
    """Return ``".mcap"`` or ``".db3"`` based on a file's content or, failing that, its name; ``""`` if neither fits."""
    try:
        head = _head(path)
    except OSError:
        head = b""
    by_content = next((suffix for magic, suffix in SUFFIXES.items() if head.startswith(magic)), "")
    return by_content or (path.suffix if path.suffix in SUFFIXES.values() else "")


def foreign(path: Path) -> str:
    """Explain what kind of file this is and what to do with it; return ``""`` for a bag file, damaged or not."""
    try:
        head = _head(path)
    except OSError as error:
        return f"it cannot be read: {error.strerror}"
    if not head:
        return "it is empty"
    for magic, what in FOREIGN.items():
        if head.startswith(magic):
            return what.format(name=_quoted(path.name), stem=_quoted(path.stem))
    if head[TAR_AT:].startswith(TAR):
        return "it is a tar archive. Unpack it first"
    return _text(head) or ("" if suffix_of(path) else UNKNOWN)


def _text(head: bytes) -> str:
    try:
        text = head.decode(errors="ignore" if len(head) == HEAD else "strict")  # the head may end within a character
    except UnicodeDecodeError:
        return ""
    if text.lstrip().lower().startswith(WEB_PAGE):
        return "it is a web page, not the file itself. Download the file again"
    return "it is a text file" if "".join(text.split()).isprintable() else ""


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(HEAD)


def _quoted(name: str) -> str:
    return printable(shlex.quote(name))
