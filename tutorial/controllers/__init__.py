"""The controllers that the tutorial builds.

Projects refer to a controller by its class name. Its file has the same name in lower_snake_case, and there is no
separate list.
"""
