"""``tank bag``: a drive is recorded, looked at and played, by programs in processes of their own."""

from __future__ import annotations

import json
import re

import pytest
from programs import until

from tutorial.errors import TutorialError
from tutorial.ros.bags import Bag

JOINTS = "/Tank/joint_state"
VIEWER = ("run", "step3", "--headless", "--duration", 1, "--linger", 60, "--report")
CALLED = ("--ros-args", "-r", "__node:=viewer")


def payloads(path, topic=JOINTS):
    return [data for _, _, data in Bag(path).raw_messages([topic])]


def count(path):
    """How many messages are in a bag that is being written, or about to be."""
    try:
        return sum(topic.count for topic in Bag(path).topics)
    except TutorialError:
        return 0


def report(folder, node):
    return json.loads((folder / f"{node}.json").read_text())


@pytest.mark.process
def test_a_drive_is_recorded_and_played_into_the_same_final_joints(program, tank, tmp_path):
    """Three recorders: that of the run, one of all topics, and one that is killed in the middle."""
    everything = program("bag", "record", "-a", "-o", tmp_path / "all")
    doomed = program("bag", "record", JOINTS, "-o", tmp_path / "doomed")
    everything.says("recording into ")
    doomed.says("recording into ")
    viewer = program(*VIEWER, tmp_path, *CALLED)
    joy = program("joy", "--drive", "tour", "--duration", 6)
    simulation = program("run", "step2", "--headless", "--duration", 4, "--bag", tmp_path / "run", "--report", tmp_path)
    until(lambda: count(tmp_path / "doomed") >= 50, "fifty messages in the bag that will be cut off")
    doomed.process.kill()
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
    cut_off = payloads(tmp_path / "doomed")
    first = run.index(cut_off[0])
    assert cut_off == run[first : first + len(cut_off)]
    assert len(cut_off) >= 50
    info = tank("bag info", tmp_path / "doomed")
    assert f"Messages:          {len(cut_off)}\n" in info.stdout
    assert "This bag is damaged, and is read as far as it goes: its metadata.yaml is missing" in info.stderr

    again = program(*VIEWER, tmp_path / "again", *CALLED)
    again.says("- JointStateSubscriber")
    player = program("bag", "play", tmp_path / "run", "--rate", 4, "--clock", "--topics", JOINTS)
    assert [player.ends(), again.ends()] == [0, 0]
    assert "200 messages played\n" in player.output
    assert report(tmp_path / "again", "viewer")["joints"] == report(tmp_path, "viewer")["joints"]

    endless = tank("bag play --loop --rate 100", tmp_path / "run", once="Ctrl-C ends it")
    assert (endless.status, endless.stdout.endswith("messages played\n")) == (0, True)
    assert "Traceback" not in player.output


def test_a_topic_that_nobody_publishes_is_waited_for_and_said(tank, tmp_path):
    waits = "waiting for /nobody, which nobody publishes yet"
    run = tank("bag record /nobody -s sqlite3 -o", tmp_path / "bag", once=waits)
    assert (run.status, "0 messages of 0 topics in 0.0 s\n" in run.stdout) == (0, True)
    assert Bag(tmp_path / "bag").damage == ""
    again = tank("bag record -a -o", tmp_path / "bag")
    assert (again.status, "and a bag overwrites nothing. Give another name." in again.stderr) == (1, True)
    played = tank("bag play", tmp_path / "bag")
    assert (played.status, "Error: there is nothing to play" in played.stderr) == (1, True)
