"""A real kernel without a page."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from tempfile import TemporaryDirectory

import psutil
from jupyter_client.manager import KernelManager
from programs import TIMEOUT


class Kernel:
    """Runs cells in a separate process."""

    def __init__(self, manager: KernelManager) -> None:
        self.manager = manager
        self.client = manager.client()
        self.client.start_channels()
        self.client.wait_for_ready(timeout=TIMEOUT)

    @property
    def process(self) -> psutil.Process:
        return psutil.Process(self.manager.provisioner.process.pid)

    def run(self, code: str) -> str:
        """Run a cell, and return its output; fail if the cell fails."""
        said = []
        reply = self.client.execute_interactive(code, timeout=TIMEOUT, output_hook=said.append)["content"]
        assert reply["status"] == "ok", "\n".join(reply.get("traceback", ["interrupted"]))
        return "".join(message["content"]["text"] for message in said if message["msg_type"] == "stream")

    def interrupt(self, code: str, once: Callable[[dict], object]) -> dict:
        """Run a cell, interrupt it after a certain message, and return the reply."""
        message_id = self.client.execute(code, stop_on_error=False)  # otherwise a quick next cell would not run
        while not once(self.client.get_iopub_msg(timeout=TIMEOUT)):
            pass
        self.manager.interrupt_kernel()
        while (reply := self.client.get_shell_msg(timeout=TIMEOUT))["parent_header"].get("msg_id") != message_id:
            pass
        return reply["content"]


@contextmanager
def kernel() -> Iterator[Kernel]:
    """Start a kernel of this environment, and kill what is left of it at the end."""
    with TemporaryDirectory(prefix="kernel-") as folder, ExitStack() as stack:
        manager = KernelManager(kernel_name="python3", transport="ipc", ip=f"{folder}/socket")
        manager.kernel_spec.argv[0] = sys.executable
        manager.start_kernel()
        stack.callback(manager.shutdown_kernel, now=True)
        running = Kernel(manager)
        stack.callback(running.client.stop_channels)
        yield running
