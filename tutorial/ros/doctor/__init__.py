"""Find out why no messages arrive on a topic.

`observe` collects facts, `rules` contains the table of causes and does not need ROS 2, and `report` writes the text.
"""
