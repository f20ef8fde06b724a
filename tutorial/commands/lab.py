"""The command ``tank lab``: JupyterLab with the course's notebooks."""

import logging
import os
import re
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import nbformat
import zmq
from nbformat.sign import NotebookNotary

from tutorial.errors import TutorialError
from tutorial.system.paths import HOME, PACKAGE, SHIPPED, is_ours

_log = logging.getLogger(__name__)

OWN = "tank-tutorial"
"""The name of a learner's own course folder."""

BROWSER_IS_ELSEWHERE = ("WSL_DISTRO_NAME", "VSCODE_IPC_HOOK_CLI")
"""Variables set by WSL, or by VS Code's terminals in containers and on remote machines."""


def own_course() -> Path:
    """Return the learner's course folder, after creating it in the current directory if necessary.

    Learners should not edit the notebooks of an installed package: all users would see the changes, and the next
    version would overwrite them. Therefore, the notebooks are copied, with all files that they refer to. Existing files
    in the learner's folder stay unchanged; only missing files are added, such as a new notebook from a later version.

    Raises:
        TutorialError: the folder cannot be written to, or belongs to another user.
    """
    elsewhere = "Change to a folder of your own, for instance with cd ~, and try again."
    course = Path.cwd() / OWN if HOME == SHIPPED else HOME
    if course.exists() and not is_ours(course):
        raise TutorialError(f"{course} belongs to another user. {elsewhere}")
    if (course / "tutorial" / "__init__.py").exists():  # a checkout already has all course files
        return course
    try:
        added = _add_missing(course)
    except OSError as error:
        raise TutorialError(f"the course cannot be copied to {course}: {error.strerror}. {elsewhere}") from error
    if added:
        _log.info("added the missing course files to %s; your changes there are kept", course)
    return course


def lab_command(arguments: Sequence[str] = (), course: Path = HOME) -> list[str]:
    """Return the command that opens the first notebook in a local JupyterLab, with little output.

    Under JupyterHub, JupyterLab runs as the student's server, and the hub decides where that server listens.

    Args:
        arguments: additional arguments for JupyterLab, which override the settings made here.
        course: the course folder, which becomes JupyterLab's root.
    """
    in_hub = "JUPYTERHUB_SERVICE_URL" in os.environ and "JUPYTER_SERVER_URL" not in os.environ  # terminals set both
    settings = {
        "ServerApp.root_dir": course,
        "LabApp.default_url": "/lab/tree/notebooks/0_setup.ipynb",
        "ServerApp.allow_root": True,  # in a container, root is the only user
        "ServerApp.allow_origin_pat": _forwarded_origin(),
        "ServerApp.max_body_size": 64_000_000,  # [bytes] per request, even before authentication; notebooks are smaller
        "ServerApp.use_redirect_file": not any(os.environ.get(name) for name in BROWSER_IS_ELSEWHERE),
        "ServerApp.answer_yes": True,  # a single Ctrl-C stops the server
        "Application.log_level": "ERROR",
        "LabApp.news_url": None,  # otherwise, JupyterLab asks each learner whether to show its news
        # Without encryption, each kernel logs a warning.
        **({"KernelManager.transport_encryption": "auto"} if zmq.has("curve") else {}),
        **({} if in_hub else {"ServerApp.ip": "127.0.0.1"}),
    }
    program = "jupyterhub.singleuser" if in_hub else "jupyterlab"
    given = {argument.removeprefix("--").partition("=")[0] for argument in arguments}
    options = (f"--{name}={value}" for name, value in settings.items() if name not in given)
    return [sys.executable, "-P", "-m", program, *options, *arguments]


def _forwarded_origin() -> str:
    """Return a regular expression that matches the origins of this GitHub codespace; empty outside of a codespace."""
    name, domain = map(os.environ.get, ("CODESPACE_NAME", "GITHUB_CODESPACES_PORT_FORWARDING_DOMAIN"))
    return rf"https://{re.escape(name)}-\d+\.{re.escape(domain)}" if name and domain else ""


def trust(folder: Path, **settings: str) -> None:
    """Sign the course's notebooks as ``jupyter trust`` does, skipping unreadable ones.

    After the page is reloaded, JupyterLab shows no widgets in an untrusted notebook, and it does not trust notebooks
    that somebody else has run.

    Args:
        folder: the notebooks' folder.
        settings: settings for Jupyter's notary, for instance ``data_dir``.
    """
    logging.getLogger("traitlets").setLevel(logging.WARNING)  # the notary logs the path of its key at info level
    notary = NotebookNotary(**settings)  # type: ignore[no-untyped-call]
    for path in sorted(folder.glob("[0-9]*_*.ipynb")):
        try:
            notary.sign(nbformat.read(path, as_version=4))  # type: ignore[no-untyped-call]
        except Exception as error:  # noqa: BLE001 - JupyterLab will report what is wrong with it
            _log.warning("%s could not be signed: %s", path.name, str(error).partition("\n")[0])
    notary.store.close()


def _add_missing(course: Path) -> int:
    """Copy the missing files to a learner's course folder; return how many files were missing.

    Copies are writable even if the originals are not. Each copy is moved into place when it is complete.
    """
    missing = [(target, source) for target, source in _course_files(course) if not target.exists()]
    for target, source in missing:
        target.parent.mkdir(parents=True, exist_ok=True)
        part = target.with_name(f".{target.name}.part")
        shutil.copyfile(source, part)
        part.replace(target)
    return len(missing)


def _course_files(course: Path) -> Iterator[tuple[Path, Path]]:
    """Yield each file of a learner's course folder, with the original file to copy.

    The files include the library's controllers, because the notebooks refer to them.
    """
    for source in SHIPPED.rglob("*"):
        if source.is_file() and source.suffix != ".pyc":  # pip also compiles the launch files
            yield course / source.relative_to(SHIPPED), source
    for source in (PACKAGE / "controllers").glob("[a-z]*.py"):
        yield course / "tutorial" / "controllers" / source.name, source
