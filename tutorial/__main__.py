"""``python -m tutorial``, and the command ``tank``."""

import gc
import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # until a command takes Ctrl-C over, it ends all without a traceback
signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # which waits for this where `parent_watch` starts it

gc.disable()  # what is imported stays
from tutorial.commands.tank import main  # noqa: E402 - it takes a moment, in which Ctrl-C may come

gc.freeze()
gc.enable()

if __name__ == "__main__":
    main()
