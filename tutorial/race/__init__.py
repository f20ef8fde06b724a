"""The rules of a race along a yellow line. The referee is `tutorial.controllers.referee`."""
