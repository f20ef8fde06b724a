"""The files of the step that `test_further_step.py` adds to a copy of the course are tested there."""

collect_ignore = ["further_step"]
