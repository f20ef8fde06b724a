"""The widgets for notebook cells: the 3D view, the joystick, and the pictures that explain a program.

Widgets use the notebook's connection to its kernel, so they need no server, no port and no second origin. Messages from
the page can arrive on any thread, even while a cell runs: a widget's handler posts them and returns.
"""
