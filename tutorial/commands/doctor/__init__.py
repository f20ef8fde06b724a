"""``tank doctor``: what this machine has for the tutorial, what is in the way, and the mend."""

from tutorial.commands.doctor.examination import doctor

__all__ = ["doctor"]
