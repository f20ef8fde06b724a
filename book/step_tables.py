"""The tables of steps in the README and the book, made from one list: ``make steps`` writes them."""

import re
from pathlib import Path

HOME = Path(__file__).parents[1]
TABLE = re.compile(r"(?<=^\| step \|).*\n(?:\|.*\n)+", re.MULTILINE)

STEPS = (
    ("setup", "nothing: you see the tank, and who talks to whom", ""),
    ("tank_controller", "a controller that listens to the joystick", "`/joy`"),
    ("joint_state_publisher", "a publisher of joint states", "`/Tank/joint_state`"),
    ("joint_state_subscriber", "a viewer, in a second program", "`/Tank/joint_state`"),
    ("imu_publisher", "a publisher of what the sensors measure", "`/Tank/imu`"),
    ("imu_subscriber", "a viewer of the sensors that shakes", "`/Tank/imu`"),
    ("camera_publisher", "a publisher of what the camera sees", "`/Tank/camera/image`"),
    ("pose", "where the tank is, and a viewer whose tank drives", "`/tf`"),
    ("bag_recorder", "a recorder of messages, whose bag you play again", "`/Tank/joint_state`"),
)
"""Of each step the name, what you build, and the topic. Its files have its name or number, or begin with it."""

PAGES = {
    "README.md": ("step", "notebook", "you build", "controller", "project", "launch file", "topic"),
    "book/index.md": ("notebook on the page", "you build", "topic"),
}
"""By page, what is in the columns."""


def pages() -> dict[Path, str]:
    """What the pages are, with their tables as they should be."""
    rows = [_row(number, *step) for number, step in enumerate(STEPS)]
    written = {}
    for page, columns in PAGES.items():
        head = "".join(f" {column} |" for column in columns[1:]) + f"\n{'|---' * len(columns)}|\n"
        body = "".join("|" + "".join(f" {row[column]} |" for column in columns) + "\n" for row in rows)
        table = (head + body).replace("|  |", "| |").replace("|  |", "| |")
        written[HOME / page] = TABLE.sub(lambda _, table=table: table, (HOME / page).read_text(encoding="utf-8"))
    return written


def _row(number: int, name: str, builds: str, topic: str) -> dict[str, str]:
    notebook = f"notebooks/{number}_{name}.ipynb"
    return {
        "step": str(number),
        "notebook": f"[`{number}_{name}`]({notebook})",
        "notebook on the page": f"[Step {number}]({notebook})",
        "you build": builds,
        "controller": _files("tutorial/controllers", name, ".py"),
        "project": _files("project", f"step{number}", ".yaml"),
        "launch file": _files("launch_py", f"step{number}", ".launch.py"),
        "topic": topic,
    }


def _files(folder: str, name: str, suffix: str) -> str:
    """Link to the files of this name, or of names that begin with it."""
    found = sorted([*HOME.glob(f"{folder}/{name}{suffix}"), *HOME.glob(f"{folder}/{name}_*{suffix}")])
    return ", ".join(f"[`{path.name}`]({folder}/{path.name})" for path in found)


if __name__ == "__main__":
    for page, text in pages().items():
        page.write_text(text, encoding="utf-8")
