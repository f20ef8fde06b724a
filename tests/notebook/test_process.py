"""The effects of importing `tutorial.notebook` on a kernel."""

import logging
import os
from contextlib import ExitStack
from types import SimpleNamespace

import pytest
from ipykernel.comm.comm import BaseComm
from ipykernel.kernelbase import Kernel
from IPython.core.formatters import DisplayFormatter
from kernels import kernel
from programs import TIMEOUT

from tutorial.checks.tank_controller import drive
from tutorial.notebook import close_all, process, topic_list
from tutorial.notebook.desk import logged


@pytest.fixture
def prepare(monkeypatch):
    """Prepare this process for a notebook, with environment variables; return the shell and the exit functions."""
    shell, at_exit = SimpleNamespace(display_formatter=DisplayFormatter()), []
    with ExitStack() as until_exit, monkeypatch.context() as patch:
        patch.setattr(process, "_until_exit", until_exit)
        patch.setattr(process, "get_ipython", lambda: shell)
        patch.setattr(process.atexit, "register", at_exit.append)

        def run(**variables):
            for name in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
                patch.delenv(name, raising=False)
            for name, value in variables.items():
                patch.setenv(name, value)
            process.prepare_process()
            return shell, at_exit

        yield run


def test_a_forgotten_await_is_explained(prepare):
    shell, _ = prepare()
    for call, name in ((topic_list(), "topic_list"), (drive.check(), "Exercise.check")):
        shown, _ = shell.display_formatter.format(call)
        assert shown["text/plain"] == f"{name} has not run yet: this call takes a while, so write await before it."


def test_notebooks_have_separate_local_domains_by_default(prepare):
    domains = [prepare() and os.environ["ROS_DOMAIN_ID"] for _ in range(2)]
    assert domains[0] != domains[1]
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
    prepare(ROS_DOMAIN_ID="7", ROS_AUTOMATIC_DISCOVERY_RANGE="OFF")
    assert (os.environ["ROS_DOMAIN_ID"], os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"]) == ("7", "OFF")


def test_log_lines_stay_in_the_notebook_and_exit_closes_everything(prepare):
    logger = logging.getLogger("tutorial")
    assert logged in logger.handlers
    assert prepare()[1] == [close_all]
    assert not logger.propagate


def test_without_ipython_nothing_is_explained(prepare, monkeypatch):
    for shell in (None, SimpleNamespace(display_formatter=None)):
        monkeypatch.setattr(process, "get_ipython", lambda shell=shell: shell)
        prepare()


def test_names_in_ipykernel():
    assert callable(BaseComm._reply_subshell_for)
    assert callable(Kernel()._main_asyncio_lock.locked)


@pytest.mark.process
def test_messages_of_pages_do_not_change_a_cells_parent():
    with kernel() as running:
        comm_id = running.run("import asyncio, comm, tutorial.notebook\nprint(comm.create_comm().comm_id)")
        client = running.client
        for number in range(50):
            cells = {client.execute(f"await asyncio.sleep({seconds})") for seconds in (0.001, 0)}
            for _ in range(number % 6):
                client.shell_channel.send(client.session.msg("comm_msg", {"comm_id": comm_id.strip(), "data": {}}))
            while cells:
                said = client.get_iopub_msg(timeout=TIMEOUT)
                if said["content"].get("execution_state") == "idle":
                    cells.discard(said["parent_header"]["msg_id"])
