"""Find out why no messages of a topic arrive.

`observe` collects facts, `rules` has one table of causes, which needs no ROS 2, and `report` writes the text.
"""
