"""How far the learner has come."""

from __future__ import annotations

from tutorial.checks.catalogue import exercise_names
from tutorial.progress import Overview


def progress(step: int | None = None) -> Overview:
    """Show which exercises are solved; that is remembered beside the notebook, in ``.tank_progress.json``.

    Args:
        step: the number of the only step to show; None for all.
    """
    return Overview(exercise_names(step))
