"""Generate the tables of steps in the README and the book from one list: ``make steps`` writes them."""

import re
from pathlib import Path

HOME = Path(__file__).parents[1]
TABLE = re.compile(r"(?<=^\| step \|).*\n(?:\|.*\n)+", re.MULTILINE)

STEPS = (
    ("setup", "nothing yet: you drive the tank and see which programs talk to each other", ""),
    ("tank_controller", "a controller that listens to the joystick", "`/joy`"),
    ("joint_state_publisher", "a publisher of joint states", "`/Tank/joint_state`"),
    ("joint_state_subscriber", "a viewer in a second program", "`/Tank/joint_state`"),
    ("imu_publisher", "a publisher of sensor measurements", "`/Tank/imu`"),
    ("imu_subscriber", "a viewer that shows the measurements and shakes its tank after a collision", "`/Tank/imu`"),
    ("camera_publisher", "a publisher of camera images", "`/Tank/camera/image`"),
    ("pose", "a publisher of the tank's pose, and a viewer that shows this pose", "`/tf`"),
    ("bag_recorder", "a recorder that writes messages into a bag, which you play back", "`/Tank/joint_state`"),
    ("nothing_arrives", "fixes for eight viewers that show nothing", "`/tank1/joint_state` to `/tank8/joint_state`"),
    ("services", "services, clients, parameters, and three fixes for a deadlock", "`/Tank/reset`, `/Tank/set_motors`"),
    ("race", "your own driver: a node that follows a line and gets a score", "`/joy`"),
)
"""Each step's name, what you build in it, and its topics. The names of a step's files begin with its name or number."""

PAGES = {
    "README.md": ("step", "notebook", "you build", "controller", "project", "launch file", "topic"),
    "book/index.md": ("notebook on the page", "you build", "topic"),
}
"""The columns of each page's table."""


def pages() -> dict[Path, str]:
    """Return the text of each page with up-to-date tables."""
    rows = [_row(*step) for step in STEPS]
    written = {}
    for page, columns in PAGES.items():
        head = "".join(f" {column} |" for column in columns[1:]) + f"\n{'|---' * len(columns)}|\n"
        body = "".join("|" + "".join(f" {row[column]} |" for column in columns) + "\n" for row in rows)
        table = (head + body).replace("|  |", "| |").replace("|  |", "| |")
        written[HOME / page] = TABLE.sub(lambda _, table=table: table, (HOME / page).read_text(encoding="utf-8"))
    return written


def _row(name: str, builds: str, topic: str) -> dict[str, str]:
    (path,) = HOME.glob(f"notebooks/[0-9]*_{name}.ipynb")
    number, notebook = path.stem.partition("_")[0], f"notebooks/{path.name}"
    return {
        "step": number,
        "notebook": f"[`{number}_{name}`]({notebook})",
        "notebook on the page": f"[Step {number}]({notebook})",
        "you build": builds,
        "controller": _files("tutorial/controllers", name, ".py"),
        "project": _files("project", f"step{number}", ".yaml"),
        "launch file": _files("launch_py", f"step{number}", ".launch.py"),
        "topic": topic,
    }


def _files(folder: str, name: str, suffix: str) -> str:
    """Return links to the files whose names are `name` or begin with `name_`."""
    found = sorted([*HOME.glob(f"{folder}/{name}{suffix}"), *HOME.glob(f"{folder}/{name}_*{suffix}")])
    return ", ".join(f"[`{path.name}`]({folder}/{path.name})" for path in found)


if __name__ == "__main__":
    for page, text in pages().items():
        page.write_text(text, encoding="utf-8")
