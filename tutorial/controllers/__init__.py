"""The controllers that the tutorial builds, one file per step.

Projects name a controller by its class; its file has the same name in lower_snake. There is no other list of them.
"""
