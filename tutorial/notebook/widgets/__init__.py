"""The widgets for notebook cells: the 3D view, the joystick, and the pictures that explain a program.

Widgets use the notebook's connection to its kernel, so they need no server, no port and no second origin. Messages from
the page can arrive on any thread, even while a cell runs, so a widget's handler only passes each message on to the
thread that needs it, and returns.
"""
