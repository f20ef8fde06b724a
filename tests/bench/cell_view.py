"""Measure a frame of the 3D view in a cell, in a separate kernel."""

import atexit
import threading
from pathlib import Path

import zmq
from costs import Timed
from jupyter_client.manager import start_new_kernel


def cell_frame() -> tuple[Timed, Timed]:
    """Measure a frame that moves all of the tank, sent to a page from a kernel; and meshcat's own calls."""
    manager, client = start_new_kernel()
    atexit.register(manager.shutdown_kernel, now=True)

    def execute(code: str) -> str:
        printed: list[str] = []
        hook = printed.append
        reply = client.execute_interactive(code, output_hook=lambda message: hook(message["content"].get("text", "")))
        if reply["content"]["status"] != "ok":
            raise RuntimeError("\n".join(reply["content"]["traceback"]))
        return "".join(printed)

    execute(f"import sys; sys.path.append({str(Path(__file__).parent)!r}); import tutorial")
    execute(f"from costs import frame; ours, reference = frame({_answering()!r})")
    return lambda: float(execute("print(ours())")), lambda: float(execute("print(reference())"))


def _answering() -> str:
    """Return the local address of a socket that answers meshcat in place of its server."""
    socket = zmq.Context.instance().socket(zmq.REP)
    port = socket.bind_to_random_port("tcp://127.0.0.1")

    def answer() -> None:
        while True:
            socket.recv_multipart()
            socket.send(b"ok")

    threading.Thread(target=answer, daemon=True).start()
    return f"tcp://127.0.0.1:{port}"
