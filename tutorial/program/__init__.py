"""A running program: its project file, its bodies with their controllers, its node and main loop, and its record."""
