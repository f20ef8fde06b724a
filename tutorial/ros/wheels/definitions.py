"""Find the first mistake in interface definitions: ``python definitions.py PACKAGE PREFIX FILE...`` prints it.

ROS 2's own parser says what is wrong, but not in which line. It is called with more and more lines until it fails. This
runs in a process of its own, because the parser is in the folder of the real ROS 2.
"""

import sys
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path
from typing import Any

PARTS = {".msg": 1, ".srv": 2, ".action": 3}
"""The number of parts into which ``---`` divides a definition."""


def main(package: str, prefix: str, *files: str) -> None:
    """Print the first mistake in some files, and where it is; nothing if there is none."""
    mistakes = filter(None, (_find_mistake(package, Path(prefix), Path(file)) for file in files))
    sys.stdout.write(next(mistakes, ""))


def _find_mistake(package: str, prefix: Path, file: Path) -> str:
    from rosidl_adapter.parser import parse_message_string  # noqa: PLC0415 - no other Python finds it

    place = f"{file.parent.name}/{file.name}"
    lines = file.read_text(encoding="utf-8").splitlines()
    ends = [number for number, line in enumerate(lines) if line.strip() == "---"] + [len(lines)]
    if len(ends) != PARTS[file.suffix]:
        return f"{place} has {len(ends)} part(s) separated by ---, but a {file.suffix} file needs {PARTS[file.suffix]}"
    start = 0
    for end in ends:
        for last in range(start, end):
            try:
                with redirect_stderr(StringIO()):  # the parser also prints some of its errors
                    message = parse_message_string(package, file.stem, "\n".join(lines[start : last + 1]))
                _check_types(message, package, prefix, file.parents[1])
            except Exception as error:  # noqa: BLE001 - the parser raises a dozen kinds, NameError among them
                return f"{place}, line {last + 1} ({lines[last].strip()}): {type(error).__name__}: {error}"
        start = end + 1
    return ""


def _check_types(message: Any, package: str, prefix: Path, source: Path) -> None:
    """Check that the message type of the last field exists, and that its package is known to the build.

    Raises:
        LookupError: there is no such message, or CMakeLists.txt does not name its package.
    """
    for kind in (field.type for field in message.fields[-1:] if not field.type.is_primitive_type()):
        other = kind.pkg_name
        home = source if other == package else prefix / "share" / other
        if not (home / f"msg/{kind.type}.msg").exists():
            raise LookupError(f"there is no message {other}/{kind.type}")
        if other != package and other not in (source / "CMakeLists.txt").read_text(encoding="utf-8"):
            raise LookupError(f"CMakeLists.txt needs find_package({other} REQUIRED), and {other} after DEPENDENCIES")


if __name__ == "__main__":
    main(*sys.argv[1:])
