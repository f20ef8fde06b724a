"""The command ``tank``, and what its parts are made of."""
