"""Bags: what went over topics, kept in files that ``ros2 bag`` reads and writes, too. Nothing here prints."""

from tutorial.ros.bags.bag import Bag, BagTopic
from tutorial.ros.bags.info import bag_info
from tutorial.ros.bags.player import Player
from tutorial.ros.bags.recorder import Recorder

__all__ = ["Bag", "BagTopic", "Player", "Recorder", "bag_info"]
