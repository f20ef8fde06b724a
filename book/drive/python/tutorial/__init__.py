"""The parts of the course that run in the page."""
