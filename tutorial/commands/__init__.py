"""The command ``tank`` and its subcommands."""
