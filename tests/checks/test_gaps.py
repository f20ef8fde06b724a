"""The exercise `gaps`: every wrong answer is told from the others."""

from __future__ import annotations

from itertools import pairwise

import pytest
from rclpy.time import Time

from tutorial.checks.bag_recorder import find_gaps, gaps

TENTH, SECOND = 100_000_000, 1_000_000_000


def stamp_of(message):
    return Time.from_msg(message.header.stamp).nanoseconds


def seconds_of(message):
    return message.header.stamp.sec + message.header.stamp.nanosec * 1e-9


def walk(stamps, gap=TENTH, restart=SECOND, keeps=max):
    """What is right where the stamps are; `keeps` says what the next one is compared with."""
    found, newest = [], None
    for stamp in stamps:
        if newest is None:
            newest = stamp
        elif stamp - newest > gap:
            found.append(("gap", newest, stamp))
            newest = stamp
        elif newest - stamp > restart:
            found.append(("restart", newest, stamp))
            newest = stamp
        else:
            newest = keeps(newest, stamp)
    return found


# --- right answers


def by_hand(messages):
    return walk(message.header.stamp.sec * SECOND + message.header.stamp.nanosec for _, message in messages)


def as_lists(messages):
    return tuple(list(each) for each in find_gaps(messages))


def with_durations(messages):
    found, newest = [], None
    for _, message in messages:
        stamp = Time.from_msg(message.header.stamp)
        ahead = (stamp - newest).nanoseconds if newest is not None else 0
        if ahead > TENTH or ahead < -SECOND:
            found.append(("gap" if ahead > 0 else "restart", newest.nanoseconds, stamp.nanoseconds))
        if newest is None or ahead > 0 or ahead < -SECOND:
            newest = stamp
    return found


# --- wrong ones


def the_bags_times(messages):
    return walk(time_ns for time_ns, _ in messages)


def only_sec(messages):
    return walk((message.header.stamp.sec for _, message in messages), 0.1, 1)


def only_sec_as_nanoseconds(messages):
    return walk(message.header.stamp.sec * SECOND for _, message in messages)


def whole_milliseconds(messages):
    return walk(stamp_of(message) // 1_000_000 * 1_000_000 for _, message in messages)


def only_nanosec(messages):
    return walk(message.header.stamp.nanosec for _, message in messages)


def floating(messages):
    return walk((seconds_of(message) for _, message in messages), 0.1, 1.0)


def floating_nanoseconds(messages):
    found = walk((seconds_of(message) for _, message in messages), 0.1, 1.0)
    return [(what, round(before * 1e9), round(after * 1e9)) for what, before, after in found]


def in_seconds(messages):
    return [(what, before / SECOND, after / SECOND) for what, before, after in find_gaps(messages)]


def in_milliseconds(messages):
    return [(what, before / 1_000_000, after / 1_000_000) for what, before, after in find_gaps(messages)]


def exchanged(messages):
    return [(what, after, before) for what, before, after in find_gaps(messages)]


def lengths(messages):
    return [(what, before, after - before) for what, before, after in find_gaps(messages)]


def only_before(messages):
    return [(what, before) for what, before, _ in find_gaps(messages)]


def the_bags_times_told(messages):
    found, newest = [], None
    for message in messages:
        stamp = stamp_of(message[1])
        ahead = stamp - stamp_of(newest[1]) if newest is not None else 0
        if ahead > TENTH or ahead < -SECOND:
            found.append(("gap" if ahead > 0 else "restart", newest[0], message[0]))
        if newest is None or ahead > 0 or ahead < -SECOND:
            newest = message
    return found


def places(messages):
    stamps = [stamp_of(message) for _, message in messages]
    return [(what, stamps.index(before), stamps.index(after)) for what, before, after in find_gaps(messages)]


def the_last_told(messages):
    found, newest, last = [], None, None
    for _, message in messages:
        stamp = stamp_of(message)
        ahead = stamp - newest if newest is not None else 0
        if ahead > TENTH or ahead < -SECOND:
            found.append(("gap" if ahead > 0 else "restart", last, stamp))
        newest = stamp if newest is None or ahead < -SECOND else max(newest, stamp)
        last = stamp
    return found


def with_the_last(messages):
    return walk((stamp_of(message) for _, message in messages), keeps=lambda _, stamp: stamp)


def neighbours(messages):
    stamps = [stamp_of(message) for _, message in messages]
    found = []
    for before, after in pairwise(stamps):
        if after - before > TENTH:
            found.append(("gap", before, after))
        elif before - after > SECOND:
            found.append(("restart", before, after))
    return found


def with_the_first(messages):
    return walk((stamp_of(message) for _, message in messages), keeps=lambda newest, _: newest)


def moves_never(messages):
    found = []
    newest = stamp_of(messages[0][1]) if messages else 0
    for _, message in messages:
        stamp = stamp_of(message)
        if stamp - newest > TENTH:
            found.append(("gap", newest, stamp))
        elif newest - stamp > SECOND:
            found.append(("restart", newest, stamp))
            newest = stamp
    return found


def in_order(messages):
    return walk(sorted(stamp_of(message) for _, message in messages))


def from_zero(messages):
    return walk([0, *(stamp_of(message) for _, message in messages)])


def falsy(messages):
    found, newest = [], 0
    for _, message in messages:
        stamp = stamp_of(message)
        if newest and stamp - newest > TENTH:
            found.append(("gap", newest, stamp))
        elif newest and newest - stamp > SECOND:
            found.append(("restart", newest, stamp))
            newest = stamp
        newest = max(newest, stamp)
    return found


def a_tenth_counts(messages):
    return walk((stamp_of(message) for _, message in messages), gap=TENTH - 1)


def a_zero_too_few(messages):
    return walk((stamp_of(message) for _, message in messages), gap=TENTH // 10)


def a_zero_too_many(messages):
    return walk((stamp_of(message) for _, message in messages), gap=SECOND)


def any_step_back(messages):
    return walk((stamp_of(message) for _, message in messages), restart=0)


def a_second_counts(messages):
    return walk((stamp_of(message) for _, message in messages), restart=SECOND - 1)


def a_tenth_back(messages):
    return walk((stamp_of(message) for _, message in messages), restart=TENTH)


def no_restarts(messages):
    return walk((stamp_of(message) for _, message in messages), restart=float("inf"))


def no_gaps(messages):
    return [each for each in find_gaps(messages) if each[0] == "restart"]


def both_ways(messages):
    found, newest = [], None
    for _, message in messages:
        stamp = stamp_of(message)
        if newest is not None and abs(stamp - newest) > TENTH:
            found.append(("gap", newest, stamp))
        newest = stamp if newest is None else max(newest, stamp)
    return found


def never_anew(messages):
    found, newest = [], None
    for _, message in messages:
        stamp = stamp_of(message)
        if newest is not None and stamp - newest > TENTH:
            found.append(("gap", newest, stamp))
        if newest is not None and newest - stamp > SECOND:
            found.append(("restart", newest, stamp))
        newest = stamp if newest is None else max(newest, stamp)
    return found


def from_zero_anew(messages):
    found, newest = [], None
    for _, message in messages:
        stamp = stamp_of(message)
        if newest is not None and stamp - newest > TENTH:
            found.append(("gap", newest, stamp))
        if newest is not None and newest - stamp > SECOND:
            found.append(("restart", newest, stamp))
            newest = 0
        else:
            newest = stamp if newest is None else max(newest, stamp)
    return found


def only_short_ones(messages):
    return [(what, before, after) for what, before, after in find_gaps(messages) if after - before <= SECOND]


def gives_up(messages):
    found = find_gaps(messages)
    restarts = [i for i, each in enumerate(found) if each[0] == "restart"]
    return found[: restarts[0] + 1] if restarts else found


def the_first(messages):
    return find_gaps(messages)[:1]


def the_last(messages):
    return find_gaps(messages)[-1:]


def the_newest_first(messages):
    return find_gaps(messages)[::-1]


def gaps_first(messages):
    return sorted(find_gaps(messages), key=lambda each: each[0])


def late_ones_too(messages):
    found, newest = [], None
    for _, message in messages:
        stamp = stamp_of(message)
        ahead = stamp - newest if newest is not None else 0
        if ahead > TENTH or ahead < 0:
            found.append(("gap" if ahead > 0 else "restart" if ahead < -SECOND else "late", newest, stamp))
        newest = stamp if newest is None or ahead < -SECOND else max(newest, stamp)
    return found


def one_too_few(messages):
    return find_gaps(messages[:-1])


def beyond_the_end(messages):
    stamps = [stamp_of(message) for _, message in messages]
    return [("gap", stamps[i], stamps[i + 1]) for i in range(len(stamps)) if stamps[i + 1] - stamps[i] > TENTH]


def needs_one(messages):
    newest = stamp_of(messages[0][1])
    return walk([newest, *(stamp_of(message) for _, message in messages)])


def yields(messages):
    yield from find_gaps(messages)


def no_return(messages):
    find_gaps(messages)


def says_nothing(messages):
    return find_gaps(messages) or None


def only_words(messages):
    return [what for what, *_ in find_gaps(messages)]


def own_words(messages):
    return [(what.upper(), before, after) for what, before, after in find_gaps(messages)]


def texts(messages):
    return [(what, f"{before} ns", f"{after} ns") for what, before, after in find_gaps(messages)]


def times(messages):
    return [(what, Time(nanoseconds=before), Time(nanoseconds=after)) for what, before, after in find_gaps(messages)]


def sorts_in_place(messages):
    messages.sort(key=lambda pair: stamp_of(pair[1]))
    return find_gaps(messages)


def uses_up(messages):
    found = find_gaps(messages)
    while messages:
        messages.pop()
    return found


def sets_stamps(messages):
    found = find_gaps(messages)
    for _, message in messages:
        message.header.stamp = Time().to_msg()
    return found


def kept(messages, found=[]):  # noqa: B006 - the mistake
    found += find_gaps(messages)
    return found


newest_of_all: list[int] = []


def kept_newest(messages):
    stamps = [stamp_of(message) for _, message in messages]
    found = walk([*newest_of_all, *stamps])
    newest_of_all[:] = stamps[-1:]
    return found


def no_message(messages):
    return walk(stamp_of(message) for message in messages)


@pytest.mark.parametrize("answer", [find_gaps, by_hand, as_lists, with_durations])
def test_right_answers_are_right(answer):
    verdict = gaps.judge(answer)
    assert verdict.right, str(verdict)


@pytest.mark.parametrize(
    ("answer", "cause"),
    [
        (the_bags_times, "the bag's times are compared"),
        (only_sec, "nanosec is left out"),
        (only_sec_as_nanoseconds, "nanosec is left out"),
        (only_nanosec, "sec is left out"),
        (whole_milliseconds, "cut to milliseconds"),
        (floating, "floating point numbers, which are rounded"),
        (floating_nanoseconds, "floating point numbers, which are rounded"),
        (in_seconds, "told in seconds"),
        (in_milliseconds, "told in milliseconds"),
        (exchanged, "the one before comes first"),
        (lengths, "its length is told"),
        (only_before, "the stamp after is missing"),
        (the_bags_times_told, "the bag's times are told"),
        (places, "the messages' numbers are told"),
        (the_last_told, "a late one is not where the gap begins"),
        (with_the_last, "compared with the last one"),
        (neighbours, "compared with the last one"),
        (with_the_first, "newest has to move on"),
        (moves_never, "newest has to move on"),
        (in_order, "the messages are sorted first"),
        (from_zero, "newest begins with 0"),
        (falsy, "a stamp of 0 is taken for none"),
        (a_tenth_counts, "0.1 s counts as a gap"),
        (a_zero_too_few, "ten times too small"),
        (a_zero_too_many, "the limit of a gap is 1 s"),
        (any_step_back, "any step back counts as a restart"),
        (a_second_counts, "1 s back counts as a restart"),
        (a_tenth_back, "the limit of a restart is 0.1 s"),
        (no_restarts, "no restart is told"),
        (no_gaps, "no gap is told"),
        (both_ways, "abs() takes a step back for one ahead"),
        (never_anew, "does not begin anew after a restart"),
        (from_zero_anew, "newest becomes 0"),
        (only_short_ones, "however long, it is one"),
        (gives_up, "after a restart nothing is looked at any more"),
        (the_first, "return after the loop"),
        (the_last, "only the last that is found"),
        (the_newest_first, "keep the bag's order"),
        (gaps_first, "gaps and restarts are told apart"),
        (late_ones_too, "a late message is told"),
        (one_too_few, "before the last message"),
        (beyond_the_end, "an index beyond the end"),
        (needs_one, "a bag without a message is not expected"),
        (yields, "makes a generator"),
        (no_return, "return is missing"),
        (says_nothing, "return is missing"),
        (only_words, "Return a list of tuples"),
        (own_words, 'The words are "gap" and "restart".'),
        (texts, "Return a list of tuples"),
        (times, "Return a list of tuples"),
        (sorts_in_place, "leave them as they are"),
        (uses_up, "leave them as they are"),
        (sets_stamps, "leave them as they are"),
        (kept, "the list is kept from call to call"),
        (kept_newest, "newest_of_all is kept from call to call"),
        (no_message, "a tuple of 2 things: take them apart first"),
    ],
)
def test_a_wrong_answer_is_told_its_cause(answer, cause):
    verdict = gaps.judge(answer)
    assert not verdict.right
    assert cause in "\n".join(verdict.causes), str(verdict)
