"""Find a mistake in the definitions of an interface package.

ROS 2's generators often fail with an error that does not name the file, or with a bare KeyError.
"""

import re
import runpy
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path

from tutorial.ros.wheels import folder

KINDS = {"msg": "message", "srv": "service", "action": "action"}

MESSAGE = re.compile(r"^(?:(\w+)/)?([A-Z]\w*)", re.MULTILINE)
"""Matches the type of a field that holds a message, and the type's package, if given. Constants and all other fields
have lowercase types."""


def find_mistake(source: Path, package: str, prefix: Path) -> str:
    """Return the first mistake in a package's definitions and the name of its file; ``""`` if there is no mistake.

    Args:
        source: the package's folder.
        package: its name.
        prefix: the folder of the real ROS 2, which contains its parser and the messages of other packages.
    """
    parser = runpy.run_path(str(folder.site_packages(prefix) / "rosidl_adapter/parser.py"))
    makes = (source / "CMakeLists.txt").read_text(encoding="utf-8")
    for kind, name in KINDS.items():
        for file in sorted(source.glob(f"{kind}/*.{kind}")):
            place = f"{kind}/{file.name}"
            try:
                with redirect_stderr(StringIO()):  # the parser also prints some of its errors
                    parser[f"parse_{name}_file"](package, file)
            except Exception as error:  # noqa: BLE001 - it raises a dozen kinds of exceptions, even NameError
                return f"{place}: {type(error).__name__}: {error}"
            for other, message in MESSAGE.findall(file.read_text(encoding="utf-8")):
                home = prefix / "share" / other if other not in ("", package) else source
                if not (home / f"msg/{message}.msg").exists():
                    return f"{place}: there is no message {other or package}/{message}"
                if home != source and other not in makes:
                    call = f"find_package({other} REQUIRED)"
                    return f"{place}: CMakeLists.txt needs {call}, and {other} after DEPENDENCIES"
    return ""
