"""The computer that a program runs on: folders, the terminal, and processes that end with their parent."""
