"""A race of a driver along a yellow line: its rules. The referee is `tutorial.controllers.referee`."""
