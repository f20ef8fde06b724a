"""The controllers that the tutorial builds, one file per step.

A controller is known to projects by its class name; its file is called the same in lower_snake. Nothing else lists
them.
"""
