"""Cyclone DDS's codec, which the pocket ROS 2 encodes with. Nothing else of Cyclone DDS is in the page."""
