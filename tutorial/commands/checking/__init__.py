"""Checking the answers in other people's notebooks: nothing of them is run, or even read, in the teacher's process."""
