"""The files that ``tank package`` writes, made from the templates in ``template/``."""
