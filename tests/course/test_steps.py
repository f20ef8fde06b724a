"""The steps as a whole: two programs in one process, in lockstep over real topics; and as a user runs them."""

import pytest
from loops import in_a_loop, until
from scenes import commands
from sensor_msgs.msg import Joy
from tornado.websocket import websocket_connect

from tutorial.commands.launcher import load_launch_file
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.system.paths import HOME, find_project


@in_a_loop
async def test_rail_and_stick_move_the_turret_in_both_programs(domain):
    step2, step3 = (Project.load(find_project(step)) for step in ("step2", "step3"))
    async with Host(step2) as simulation, Host(step3, ["--ros-args", "-r", "__node:=viewer"]) as viewer:
        joystick = viewer.node.create_publisher(Joy, "/joy", 1)
        for end in (end for host in (simulation, viewer) for end in (*host.node.publishers, *host.node.subscriptions)):
            if end.topic_name in ("/joy", "/Tank/joint_state"):
                await until(end.get_subscription_count if hasattr(end, "publish") else end.get_publisher_count)

        async def drive(seconds, *axes):
            """Hold the sticks for some seconds."""
            joystick.publish(Joy(axes=axes))
            held = simulation.controllers["TankController"].joy
            await until(lambda: list(held.get().axes) == list(axes))
            simulation.simulation.advance(seconds)

        tank = simulation.simulation.bodies["Tank"]
        await drive(1.0, 0.0, 0.0, 0.0, 0.0)
        at_rest = tank.joint("TURRET_P").position
        await drive(5.5, 0.0, 0.5, 0.0, 0.0)  # forward, without moving the turret
        assert tank.joint("TURRET_P").position - at_rest > 0.01
        await until(lambda: viewer.record()["joints"] == simulation.record()["joints"])
        shown = viewer.record()
        counts = shown["topics"]["/Tank/joint_state"]
        assert shown["joints"]["TURRET_P"] - at_rest > 0.01
        assert abs(shown["joints"]["TURRET_Y"]) < 0.05, "no turret command was given"
        assert shown["report"].pop("matched") == 2 * counts["applied"] == 2 * counts["received"] > 0
        assert not any(shown["report"].values())
        said = simulation.record()
        published = said["topics"]["/Tank/joint_state"]["published"]
        assert (said["node"], said["seconds"], published) == ("tank", 6.5, 325)
        await drive(0.5, 0.0, 0.0, 1.0, 1.0)
        await until(lambda: viewer.record()["joints"] == simulation.record()["joints"])
        joints = viewer.record()["joints"]
        assert joints["TURRET_Y"] < -0.5, "a turn to the left, which is negative: the axis points down"
        assert joints["TURRET_P"] > 0.5, "a raised barrel"


@in_a_loop
async def test_two_nodes_with_the_same_name_are_reported(domain, caplog):
    step3 = Project.load(find_project("step3"))
    async with Host(step3) as first, Host(step3):
        await until(lambda: first.refresh() or "there are 2 nodes named /tank" in caplog.text)
        assert "--ros-args -r __node:=tank_2" in caplog.text


@pytest.mark.parametrize("path", sorted((HOME / "launch_py").glob("*.launch.py")), ids=lambda path: path.name)
def test_a_launch_files_programs_have_projects(path, backend):
    if backend == "pocket" and path.name == "step10.launch.py":
        pytest.skip("step 10 needs services, which the pocket ROS 2 does not have")
    commands = [process.cmd for process in load_launch_file(path)]
    assert [command[:2] for command in commands][:2] == [["tank", "joy"], ["tank", "run"]]
    assert all(Project.load(find_project(command[2])).bodies for command in commands[1:])


@pytest.mark.process
@in_a_loop
async def test_the_page_receives_the_moving_tank(program):
    simulation = program("run", "step2", "--ros-args", "-r", "__node:=simulation")
    program("joy", "--drive", "tour")
    simulation.says("3D view: http://127.0.0.1:")
    address = simulation.output.split("3D view: http")[1].split()[0]
    page = await websocket_connect(f"ws{address}socket")
    turret = set()
    while len(turret) < 20:
        for each in commands(await page.read_message()):
            if each["type"] == "set_transform" and each["path"].endswith("/Tank/Tank.TURRET_Y"):
                turret.add(str(each["matrix"]))
    page.close()
