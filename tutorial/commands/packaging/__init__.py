"""What ``tank package`` writes: the files of a ROS 2 package, made from the templates in ``template/``."""
