"""What is said in the end."""

from __future__ import annotations

from rich.console import Console


def judge(complaints: list[str], console: Console) -> int:
    """Say what does not hold; return the exit status."""
    for complaint in complaints:
        console.print(f"does not hold: {complaint}", style="red", highlight=False)
    if not complaints:
        console.print("all holds")
    return 1 if complaints else 0
