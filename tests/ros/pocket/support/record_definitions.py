"""Write the message definitions of the pocket ROS 2, from rosbags' store of those of ROS 2 Jazzy.

Run it after rosbags has changed them, then review the git diff.
"""

import json
from typing import Any

import pocket_ros2  # noqa: F401  (it makes _rosidl importable)

# isort: split
from _rosidl.definitions import RECORDED
from rosbags.typesys import Stores, get_typestore


def written() -> str:
    """Return the file's text: one line for each type."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for constants, fields in store.fielddefs.values():  # the original definitions, because the hashes depend on them
        fields[:] = [(name, _without_char(description)) for name, description in fields]
        constants[:] = [(name, "uint8" if base == "char" else base, value) for name, base, value in constants]
    rows = []
    for type_name, (constants, fields) in store.fielddefs.items():
        row = {
            "hash": store.hash_rihs01(type_name),
            "constants": {name: [base, int(value)] for name, base, value in constants},
            "fields": {name: _type(description) for name, description in fields},
        }
        rows.append(f"{json.dumps(type_name)}: {json.dumps(row)}")
    return "{\n" + ",\n".join(rows) + "\n}\n"


def _without_char(description: Any) -> Any:
    """Replace the .msg type char with uint8, as ROS 2 does: in the class, on the wire and in the hash."""
    if description == ("char", 0):
        return ("uint8", 0)
    if isinstance(description, tuple):
        return tuple(_without_char(part) for part in description)
    return description


def _type(description: Any) -> str:
    """Return a field's type as in a .msg file, with a message's full name."""
    kind, detail = description
    if kind.name == "NAME":
        return str(detail)
    if kind.name == "BASE":
        base, bound = detail
        return f"{base}<={bound}" if bound else str(base)
    element, size = detail
    if kind.name == "ARRAY":
        return f"{_type(element)}[{size}]"
    return f"{_type(element)}[<={size}]" if size else f"{_type(element)}[]"


def main() -> None:
    RECORDED.write_text(written(), encoding="utf-8")
    print(f"{len(json.loads(written()))} types in {RECORDED}")


if __name__ == "__main__":
    main()
