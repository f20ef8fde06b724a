"""Write the table in `nothing_arrives.md` from the doctor's rules. ``make causes`` runs this module."""

import re
from pathlib import Path

from tutorial.ros.doctor.rules import RULES
from tutorial.ros.loopback import TURN_ON

PAGE = Path(__file__).with_name("nothing_arrives.md")
TABLE = re.compile(r"(?<=<!-- made by book/cause_table.py -->\n).*?(?=<!-- end -->)", re.DOTALL)

CODE = re.compile(r"(rclpy\.spin\(node\)|/clock|\b(?:[A-Za-z]+_\w+|RELIABLE|VOLATILE|OFF|LOCALHOST|fg)\b)")
"""Names from code that appear in the rules' text."""

SIGNS = {
    "python": "`python3 -c 'import rclpy'` raises an error.",
    "loopback": "`ip link show lo` shows `state DOWN`.",
    "participants": "The program exits immediately: `Failed to find a free participant index for domain 0`.",
    "stopped": "After several seconds, `ros2 topic info TOPIC` prints `Publisher count: 0`, "
    "and `ps -eo stat,args` shows the state `T`.",
    "name": "`ros2 topic list -t` lists a topic with a similar name, "
    "and `ros2 topic info TOPIC` prints `Publisher count: 0`.",
    "domain": "`ros2 topic list` does not show the topic, but `ROS_DOMAIN_ID=5 ros2 topic list` does.",
    "type": "`ros2 topic info TOPIC` lists two types.",
    "hash": "`ros2 topic info -v TOPIC` shows two different values for `Topic type hash`.",
    "reliability": "The subscribing program prints a warning that contains `incompatible QoS` and `RELIABILITY`.",
    "durability": "The subscribing program prints a warning that contains `incompatible QoS` and `DURABILITY`.",
    "deadline": "The subscribing program prints a warning that contains `incompatible QoS` and `DEADLINE`.",
    "liveliness": "The subscribing program prints a warning that contains `incompatible QoS` and `LIVELINESS`.",
    "clock": "`ros2 param get NODE use_sim_time` prints `True`, "
    "and `ros2 topic info /clock` prints `Publisher count: 0`.",
    "silent": "`ros2 topic info TOPIC` prints `Publisher count: 1`, but `ros2 topic hz TOPIC` prints no rate.",
    "late": "`ros2 topic info -v TOPIC` prints `Durability: VOLATILE`, and the publisher publishes only once.",
    "range": "In the program's terminal, `ros2 node list` lists no nodes of other programs.",
    "rmw": "`printenv RMW_IMPLEMENTATION` prints different names in the terminals of the two programs.",
    "unknown": "`ros2 topic echo TOPIC` prints messages, but their joint names are not in the robot's description.",
    "dropped": "`ros2 topic echo TOPIC` prints messages, but their stamps jump backwards.",
    "nobody": "`ros2 topic info TOPIC` prints `Publisher count: 0` or `Unknown topic`.",
}
"""For each cause, what you see in a terminal with a real ROS 2."""


def page() -> str:
    """Return the page's text with an up-to-date table."""
    head = "| cause | what you see in a terminal | what to change |\n| --- | --- | --- |\n"
    rows = "".join(map(_row, RULES))
    return TABLE.sub(lambda _: head + rows, PAGE.read_text(encoding="utf-8"))


def _row(name: str) -> str:
    rule = RULES[name]
    title, means, fix = (CODE.sub(r"`\1`", text) for text in (rule.title, rule.means, rule.fix))
    command = f" `{rule.command}`".replace(TURN_ON, "sudo ip link set lo up") if rule.command else ""
    return f"| **{title[0].upper()}{title[1:]}.** {means} | {SIGNS[name]} | {fix}{command} |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
