"""``make soak``: that it runs, says what it found, and leaves nothing when it is stopped. What it finds in a minute is
for whoever runs it to judge."""

from __future__ import annotations

import re
import signal
import sys
from pathlib import Path

import programs
import pytest
from programs import until

SOAK = Path(__file__).parents[1] / "soak"


@pytest.fixture
def soak(program, monkeypatch):
    """Start the soak test with some arguments."""
    monkeypatch.setattr(programs, "TANK", sys.executable)
    monkeypatch.setenv("PYTHONPATH", str(SOAK.parent / "support"))
    return lambda *arguments, part="__main__.py": program(SOAK / part, *arguments)


def row(output, kind):
    """Return what the first table says about a kind of traffic."""
    line = next(line for line in output.splitlines() if line.startswith(f"│ {kind} "))
    return [cell.strip() for cell in line.strip("│").split("│")]


def test_a_flood_is_borne_and_summed_up(soak, backend):
    running = soak(1, "encapsulations", part="floods.py")
    status = running.ends()
    running.leaves_nothing()
    output = running.output
    assert ("all holds" in output, "does not hold" in output) == (status == 0, status == 1), output
    _, sent, hold, growth, lines, end = map(float, ["nan", *row(output, "encapsulations")[1:]])
    assert sent > 100
    assert hold > 0
    assert growth < 50
    assert lines == 0 or backend == "rclpy", output  # which may print that the attacker tells no type hash
    assert end < 20  # what is allowed on an idle machine is for whoever runs it


def test_a_short_run_says_what_arrived_and_what_does_not_hold(soak):
    running = soak(2)
    status = running.ends()
    running.leaves_nothing()
    output = running.output
    assert status == ("does not hold" in output), output
    assert ("all holds" in output) == (status == 0), output
    _, _, sent, received, lost, *_ = row(output, "reliable")
    assert (sent, received, lost) == ("2,000", "2,000", "0")
    for kind in ("best effort", "hand-off"):
        _, _, sent, received, lost, *_ = row(output, kind)
        assert sent == "2,000"
        assert 0 < int(received.replace(",", "")) == 2000 - int(lost.replace(",", ""))
    assert "calls that waited for the viewer's main thread" in output
    assert "33,333 hostile messages to match:" in output
    assert "3,333 hostile messages to view:" in output
    assert "were counted, but" not in output
    assert "displayed where no number is" not in output


def test_a_bag_has_what_was_sent(soak):
    running = soak(1, part="bags.py")
    status = running.ends()
    running.leaves_nothing()
    assert "1,000 sent, 1,000 in the bag, 0 missing" in running.output, running.output
    assert status == ("does not hold" in running.output)


@pytest.mark.parametrize("kind", ["reliable", "hand-off"])
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGKILL, -signal.SIGKILL)])
def test_it_leaves_nothing_when_it_is_stopped(soak, kind, number, status):
    running = soak(60, kind)
    until(lambda: re.search(r"\b[1-9]\d*% \|", running.output) and len(running.family()) == 3, "traffic")
    running.process.send_signal(number)
    assert running.ends() == status, running.output
    running.leaves_nothing()
    assert ("stopped" in running.output) == (number == signal.SIGINT)
    assert "Traceback" not in running.output


@pytest.mark.parametrize("given", [["0"], ["nan"], ["long"], ["2", "loud"]])
def test_what_cannot_be_run_is_said(soak, given):
    running = soak(*given)
    assert running.ends() == 2
    assert "Invalid value" in running.output
    assert given[-1] in running.output
