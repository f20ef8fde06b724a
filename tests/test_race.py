"""The referee's rules, on synthetic drives along a line."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tutorial.race.rules import CUT, FINISHED, LIMIT, PATIENCE, REACH, STUCK, TIME_UP, Race, Result

STRAIGHT = [(0.0, 0.0), (2.0, 0.0)]
CROSSING = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
STEP = 0.01  # [s]


def drive(line, *corners, side=0.0, speed=1.0, touched=(), on_rail=False):
    """Return a race after a drive from corner to corner, `side` metres north of them."""
    race, seconds = Race(line), 0.0
    for start, end in pairwise(corners):
        count = max(1, round(math.dist(start, end) / speed / STEP))
        for i in range(count + 1):
            x, y = (a + i / count * (b - a) for a, b in zip(start, end))
            race.update(seconds, (x, y + side, 0.1), touched, on_rail)
            seconds += STEP
    return race


def test_the_whole_line_the_rail_and_the_time_give_points():
    race = drive(STRAIGHT, (0, 0), (2, 0))
    assert (race.result.progress, race.result.score, race.over) == (1.0, 60.0, False)
    race.update(10.0, (2.0, 0.0, 0.1), (), on_rail=True)
    assert (race.result.end, race.result.score) == (FINISHED, 60 + 20 + 20 * (1 - 10 / LIMIT))
    assert str(race.result) == "rail touched: 100% of the line, 10.0 s, 0 contacts, 95.0 points"


def test_a_tank_that_stands_at_the_start_gets_no_points():
    assert drive(STRAIGHT, (0, 0), (0, 0)).result.score == 0


def test_the_rail_counts_only_after_the_end_of_the_line():
    assert not drive(STRAIGHT, (0, 0), (1, 0), on_rail=True).over


@pytest.mark.parametrize(("side", "followed"), [(0.9 * REACH, True), (-0.9 * REACH, True), (1.1 * REACH, False)])
def test_only_a_tank_that_stays_near_the_line_makes_progress(side, followed):
    assert (drive(STRAIGHT, (0, 0), (2, 0), side=side).result.progress > 0.9) == followed


def test_progress_never_shrinks():
    there = drive(STRAIGHT, (0, 0), (1, 0)).result.progress
    assert drive(STRAIGHT, (0, 0), (1, 0), (0, 0), (0, 2)).result.progress == there == pytest.approx(1 / 1.7, abs=0.01)


def test_where_the_line_crosses_itself_the_next_part_counts():
    at_the_crossing = drive(CROSSING, (0, 0), (1, 0)).result.progress
    assert drive(CROSSING, (0, 0), (1, 0), (1, -1)).result.progress < at_the_crossing + 0.1
    assert drive(CROSSING, *CROSSING).result.progress == 1.0


def test_a_line_can_be_continued_where_it_was_left():
    assert drive(STRAIGHT, (0, 0), (1, 0), (1, 1), (2, 1), (2, 0)).result.progress < 0.7
    assert drive(STRAIGHT, (0, 0), (1, 0), (1, 1), (1, 0), (2, 0)).result.progress == 1.0


def test_a_contact_counts_once_while_it_lasts():
    race = Race(STRAIGHT)
    for seconds, touched in ((0.0, ()), (0.1, ("A",)), (0.3, ("A",)), (0.4, ("A", "B")), (0.7, ()), (2.0, ("A",))):
        race.update(seconds, (0.0, 0.0, 0.1), touched, on_rail=False)
    assert race.result.touched == ("A after 0.1 s", "B after 0.4 s", "A after 2.0 s")
    assert race.result.score == 0.0, "never negative"


def test_a_tank_that_jumps_is_disqualified():
    race = drive(STRAIGHT, (0, 0), (1, 0))
    race.update(1.03, (1.5, 0.0, 0.1), (), on_rail=False)
    assert (race.result.foul, race.result.end, race.result.score) == ("the tank has jumped 0.50 m", "foul", 0.0)
    race.update(1.04, (2.0, 0.0, 0.1), (), on_rail=True)
    assert race.result.progress < 1, "a race that is over does not change"


def test_the_time_is_limited():
    race = Race(STRAIGHT, limit=1.0)
    race.update(1.0, (0.0, 0.0, 0.1), (), on_rail=False)
    assert race.result.end == TIME_UP
    race.disqualify("a foul")
    race.disqualify("another foul")
    assert race.result.foul == "a foul", "even after the end"


def test_a_tank_without_progress_is_stuck_but_may_look_for_the_rail():
    race = drive(STRAIGHT, (0, 0), *[(1, 0), (1, 1)] * 7)
    assert (race.result.end, race.result.seconds) == (STUCK, pytest.approx(1 + PATIENCE, abs=0.1))
    race = drive(STRAIGHT, (0, 0), (2, 0))
    race.update(2 * PATIENCE, (2.0, 0.0, 0.1), (), on_rail=False)
    assert not race.over


def test_a_cut_corner_ends_the_race_with_that_reason():
    corner = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]
    race = drive(corner, (0, 0), (1, 0), (2, 1), (2, 2), speed=0.2)
    assert (race.result.end, race.result.progress < 0.5) == (CUT, True)
    race = drive(CROSSING, (0, 0), (1, 0), *[(1, 0), (1, 0.05)] * 100, speed=0.5)
    assert race.result.end == STUCK, "near the crossing, but on no later part of the line"


@given(st.floats(0, 1), st.floats(0, LIMIT), st.integers(0, 99), st.sampled_from([FINISHED, ""]))
def test_a_score_is_0_to_100_and_more_is_better(progress, seconds, contacts, end):
    result = Result(progress, seconds, ("A",) * contacts, end)
    assert 0 <= result.score <= 100
    assert result.score >= Result(progress / 2, seconds, ("A",) * (contacts + 1), end).score
    assert Result(progress, seconds, ("A",) * contacts, end, foul="a foul").score == 0
