"""Checks the answers in learners' notebooks, which are never read or run in the teacher's process."""
