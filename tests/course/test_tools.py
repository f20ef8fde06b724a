"""Files for other tools: they refer only to existing topics and frames."""

import yaml
from loops import in_a_loop, until

from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.system.paths import HOME, find_project

TYPES = {"RobotModel": "std_msgs/msg/String", "Image": "sensor_msgs/msg/Image"}


@in_a_loop
async def test_rviz_shows_published_topics(domain):
    rviz = yaml.safe_load((HOME / "project/rviz/tank.rviz").read_text(encoding="utf-8"))["Visualization Manager"]
    displays = [(each["Class"].partition("/")[2], each) for each in rviz["Displays"]]
    wanted = {}
    for kind, display in displays:
        topic = display.get("Description Topic", display.get("Topic", {})).get("Value")
        if topic:
            wanted[topic] = [TYPES[kind]]
    assert len(wanted) == len(TYPES)
    wanted["/tf"] = ["tf2_msgs/msg/TFMessage"]  # rviz2 subscribes to it automatically

    async with Host(Project.load(find_project("tools"))) as host:
        names = host.node.get_publisher_names_and_types_by_node
        await until(lambda: wanted.items() <= dict(names("tank", "/")).items())
