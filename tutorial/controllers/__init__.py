"""The controllers that the tutorial builds.

Projects refer to a controller by its class name. The controller's file has the same name in lower_snake_case, so no
list of controllers is needed.
"""
