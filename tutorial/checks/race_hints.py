"""The hints of step 11. Its project has no solution to print: the score of ``tank race`` takes the place of a check."""

from tutorial.checks.exercise import SAYS

HINTS = (
    """Where does your driver give up? Watch a whole race with --view, or look at the last pictures that it got. In a
    tight bend, the line leaves the lowest quarter of the picture, although it is still visible further up. And where
    does the camera point? It moves with the barrel.""",
    """Lower the barrel for the first pictures, with axis 3, so that the camera sees the floor nearer to the tank. Use
    the lowest yellow pixels, in whatever rows they are, instead of a fixed part of the picture. Turn more sharply than
    the error suggests, and drive more slowly the more sharply you turn. If the line is gone, continue for a moment
    before you decide that it has ended. Then stop, and turn the turret to the rail.""",
    """The driver needs to remember a few things: count the pictures, and the pictures since it last saw the line. To
    lower the barrel, publish the axes [0, 0, 0, -1] for two pictures. Then, with rows and columns from np.nonzero, keep
    the columns where rows > rows.max() - height // 10, use twice the error, limited to -1 to 1, as the turn, and 0.35
    minus a tenth of the turn's size as the speed. After eight pictures without a line, publish [0, 0, -1, 0] ten times,
    and then [0, 0, 1, 0], which sweeps the turret to the right and back to the left.""",
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
