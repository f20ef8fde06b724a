"""The files that ``tank package`` generates from the templates in ``template/``."""
