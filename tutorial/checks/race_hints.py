"""Hints for step 11. Its project has no solution to print: the score of ``tank race`` takes the place of a check."""

from tutorial.checks.exercise import SAYS

HINTS = (
    """Where does your driver give up? Watch a whole race with --view, or save the images with np.save and look at the
    last ones. The lowest quarter of the image shows the floor far ahead of the tracks, so the tank turns too early
    and cuts corners; in a tight bend, the line even leaves that quarter. And where does the camera point? It moves with
    the barrel.""",
    """For the first few images, lower the barrel with axis 3, so that the camera sees the floor closer to the tank.
    Ignore the upper third of the image. In the rest, use the lowest yellow pixels instead of a fixed quarter. Turn more
    sharply than the error suggests, and drive more slowly in sharper turns. If you lose the line, drive straight ahead
    for a moment before you decide that it has ended. Then stop, ignore the images, and turn the turret (axis 2) to the
    rail.""",
    """The driver needs to remember three things: how many images it has received, how many of them since it last saw
    the line, and whether the line has ended. To lower the barrel, publish the axes [0, 0, 0, -1] for the first two
    images. Then, with rows and columns from np.nonzero, keep the columns where rows > rows.max() - height // 10. For
    the turn, use twice the error, limited to the range from -1 to 1; for the speed, use 0.35 minus a tenth of the
    absolute value of the turn. For an image without a line, publish [0, 0.25, 0, 0]. After eight such images in a row,
    the line has ended for good, even if the camera sees it again. Then publish [0, 0, -1, 0] ten times, and
    [0, 0, 1, 0] from then on: the turret sweeps to the right and back to the left.""",
)


def hint(number: int = 1) -> None:
    """Print a hint for the race.

    Args:
        number: the hint's number, from 1. Later hints reveal more.
    """
    count = len(HINTS)
    if number not in range(1, count + 1):
        text = f"There are {count} hints: hint() to hint({count})."
    else:
        more = f" hint({number + 1}) says {SAYS[number]}." if number < count else ""
        text = f"Hint {number} of {count}: {' '.join(HINTS[number - 1].split())}{more}"
    print(text)  # noqa: T201 - printing is its purpose
