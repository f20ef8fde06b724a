"""``tank bag``: a drive is recorded, looked at and played, by programs in processes of their own."""

from __future__ import annotations

import json
import re

import pytest

from tutorial.ros.bags import Bag

JOINTS = "/Tank/joint_state"
VIEWER = ("run", "step3", "--headless", "--duration", 1, "--linger", 60, "--report")
CALLED = ("--ros-args", "-r", "__node:=viewer")


def payloads(path, topic=JOINTS):
    return [data for _, _, data in Bag(path).raw_messages([topic])]


def report(folder, node):
    return json.loads((folder / f"{node}.json").read_text())


@pytest.mark.process
def test_a_drive_is_recorded_and_played_into_the_same_final_joints(program, tank, tmp_path):
    """Two recorders: that of the run, and one of all topics."""
    everything = program("bag", "record", "-a", "-o", tmp_path / "all")
    everything.says("recording into ")
    viewer = program(*VIEWER, tmp_path, *CALLED)
    joy = program("joy", "--drive", "tour", "--duration", 6)
    simulation = program("run", "step2", "--headless", "--duration", 4, "--bag", tmp_path / "run", "--report", tmp_path)
    assert [running.ends() for running in (simulation, viewer, joy)] == [0, 0, 0]
    everything.asks_to_stop()
    assert everything.ends() == 0
    assert "Traceback" not in everything.output + simulation.output

    published = report(tmp_path, "tank")["topics"][JOINTS]["published"]
    run = payloads(tmp_path / "run")
    assert len(run) == published == 200
    assert set(Bag(tmp_path / "run").channels) == {JOINTS, "/joy"}
    heard = payloads(tmp_path / "all")
    assert heard == run[-len(heard) :]
    assert re.search(r"[\d,]+ messages of \d topics in [\d.]+ s\n", everything.output)

    again = program(*VIEWER, tmp_path / "again", *CALLED)
    again.says("- JointStateSubscriber")
    player = program("bag", "play", tmp_path / "run", "--rate", 4, "--clock", "--topics", JOINTS)
    assert [player.ends(), again.ends()] == [0, 0]
    assert "200 messages played\n" in player.output
    assert "Traceback" not in player.output
    assert report(tmp_path / "again", "viewer")["joints"] == report(tmp_path, "viewer")["joints"]

    (tmp_path / "run" / "metadata.yaml").unlink()  # as a recorder leaves it that is killed
    info = tank("bag info", tmp_path / "run")
    assert f"Topic: {JOINTS} | Type: sensor_msgs/msg/JointState | Count: 200 " in info.stdout
    assert "This bag is damaged, and is read as far as it goes: its metadata.yaml is missing" in info.stderr
    endless = tank("bag play --loop --rate 100", tmp_path / "run", once="Ctrl-C ends it")
    assert (endless.status, "messages played\n" in endless.stdout) == (0, True)


def test_a_topic_that_nobody_publishes_is_waited_for_and_said(tank, tmp_path):
    waits = "waiting for /nobody, which nobody publishes yet"
    run = tank("bag record /nobody -s sqlite3 -o", tmp_path / "bag", once=waits)
    assert (run.status, "0 messages of 0 topics in 0.0 s\n" in run.stdout) == (0, True)
    assert Bag(tmp_path / "bag").damage == ""
    again = tank("bag record -a -o", tmp_path / "bag")
    assert (again.status, "and a bag overwrites nothing. Give another name." in again.stderr) == (1, True)
    played = tank("bag play", tmp_path / "bag")
    assert (played.status, "Error: there is nothing to play" in played.stderr) == (1, True)
