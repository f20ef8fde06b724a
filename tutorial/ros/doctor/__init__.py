"""Find out why no messages of a topic arrive.

`observe` collects facts, `rules` contains the table of causes and needs no ROS 2, and `report` writes the text.
"""
