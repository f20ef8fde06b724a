"""The 3D view: the scene, the drawing of bodies, the page that shows them, and replays of recorded runs."""
