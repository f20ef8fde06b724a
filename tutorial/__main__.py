"""Run the command ``tank``, which can also be started as ``python -m tutorial``."""

import gc
import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # until a command handles Ctrl-C, it ends the process without a traceback
signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # `parent_watch` starts its command with SIGINT blocked

gc.disable()  # imports create no garbage worth collecting
from tutorial.commands.tank import main  # noqa: E402 - this takes a moment, and the user may press Ctrl-C meanwhile

gc.freeze()
gc.enable()

if __name__ == "__main__":
    main()
