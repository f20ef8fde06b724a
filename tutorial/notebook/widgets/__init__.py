"""What appears inside a notebook's cell: the 3D view, the joystick, and the pictures that explain a program.

A widget lives on the notebook's own connection to its kernel: no server, no port, no second origin. What the page
sends may arrive on any thread, also while a cell runs; a widget's handler posts it and returns.
"""
