"""The mutants that are right answers, too: a check has to take them."""

from __future__ import annotations

EQUIVALENT: dict[str, dict[str, tuple[str, ...]]] = {
    "fire": {
        "a length is never negative": (
            "pressed = len(message.buttons) > 0 and message.buttons[0] == 1 → "
            "pressed = len(message.buttons) != 0 and message.buttons[0] == 1",
        ),
        "a button is 0 or 1": (
            "pressed = len(message.buttons) > 0 and message.buttons[0] == 1 → "
            "pressed = len(message.buttons) > 0 and message.buttons[0] >= 1",
        ),
    },
}
"""By exercise, and by the reason, the changes: `mutation.Mutant.change`."""
