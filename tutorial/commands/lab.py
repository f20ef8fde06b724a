"""JupyterLab on the notebooks."""

import logging
import os
import re
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import nbformat
from nbformat.sign import NotebookNotary

from tutorial.errors import TutorialError
from tutorial.system.paths import HOME, PACKAGE, SHIPPED, is_ours

_log = logging.getLogger(__name__)

OWN = "tank-tutorial"
"""What a learner's own course folder is called."""

BROWSER_IS_ELSEWHERE = ("WSL_DISTRO_NAME", "VSCODE_IPC_HOOK_CLI")
"""Variables of WSL, and of VS Code's terminals in containers and on other machines."""


def own_course() -> Path:
    """Return the course folder that the learner works in; where there is none, make one in the current directory.

    The notebooks of an installed package are not for opening: a change there would be a change for all users, and
    would be lost with the next version. So they are copied, with all that they refer to. What is in the
    learner's folder already stays as it is; only what is missing is added, such as a later version's new notebook.

    Raises:
        TutorialError: the folder cannot be written to, or belongs to somebody else.
    """
    elsewhere = "Go to a folder of your own, for instance with cd ~, and type it again."
    course = Path.cwd() / OWN if HOME == SHIPPED else HOME
    if course.exists() and not is_ours(course):
        raise TutorialError(f"{course} belongs to another user. {elsewhere}")
    if (course / "tutorial" / "__init__.py").exists():  # a checkout, which has all it needs
        return course
    try:
        added = _add_missing(course)
    except OSError as error:
        raise TutorialError(f"the course cannot be copied to {course}: {error.strerror}. {elsewhere}") from error
    if added:
        _log.info("what was missing of the course is now in %s; all that you change there stays", course)
    return course


def lab_command(arguments: Sequence[str] = (), course: Path = HOME) -> list[str]:
    """Return the command that opens JupyterLab on the first notebook: for this machine alone, and quiet.

    If a JupyterHub starts it, it is the student's server, and the hub says where it listens.

    Args:
        arguments: more of JupyterLab's own, which take the place of what is set here.
        course: the course folder, which is all that JupyterLab shows.
    """
    in_hub = "JUPYTERHUB_SERVICE_URL" in os.environ and "JUPYTER_SERVER_URL" not in os.environ  # which terminals have
    settings = {
        "ServerApp.root_dir": course,
        "LabApp.default_url": "/lab/tree/notebooks/0_setup.ipynb",
        "ServerApp.allow_root": True,  # for in a container there is nobody else
        "ServerApp.allow_origin_pat": _forwarded_origin(),
        "ServerApp.max_body_size": 64_000_000,  # bytes, read before it is asked who sent them; notebooks are smaller
        "ServerApp.use_redirect_file": not any(os.environ.get(name) for name in BROWSER_IS_ELSEWHERE),
        "ServerApp.answer_yes": True,  # one Ctrl-C ends it
        "Application.log_level": "ERROR",
        **({} if in_hub else {"ServerApp.ip": "127.0.0.1"}),
    }
    program = "jupyterhub.singleuser" if in_hub else "jupyterlab"
    given = {argument.removeprefix("--").partition("=")[0] for argument in arguments}
    options = (f"--{name}={value}" for name, value in settings.items() if name not in given)
    return [sys.executable, "-P", "-m", program, *options, *arguments]


def _forwarded_origin() -> str:
    """The addresses by which a browser reaches a GitHub codespace, a regular expression; empty elsewhere."""
    name, domain = map(os.environ.get, ("CODESPACE_NAME", "GITHUB_CODESPACES_PORT_FORWARDING_DOMAIN"))
    return rf"https://{re.escape(name)}-\d+\.{re.escape(domain)}" if name and domain else ""


def trust(folder: Path, **settings: str) -> None:
    """Sign the course's notebooks as the user's own, as ``jupyter trust`` does. One that cannot be read is left out.

    JupyterLab shows no widget of a notebook that it does not trust when its page is loaded anew, and one that somebody
    else has run is not trusted.

    Args:
        folder: whose notebooks.
        settings: of Jupyter's notary, for instance ``data_dir``.
    """
    logging.getLogger("traitlets").setLevel(logging.WARNING)  # it tells everyone where it keeps its key
    notary = NotebookNotary(**settings)  # type: ignore[no-untyped-call]
    for path in sorted(folder.glob("[0-9]_*.ipynb")):
        try:
            notary.sign(nbformat.read(path, as_version=4))  # type: ignore[no-untyped-call]
        except Exception as error:  # noqa: BLE001 - whatever is wrong with it, JupyterLab will say
            _log.warning("%s is not trusted: %s", path.name, str(error).partition("\n")[0])
    notary.store.close()


def _add_missing(course: Path) -> int:
    """Copy the files that are not in a learner's course folder; return how many.

    A file may be read-only, its copy may be written. The copy is there as a whole or not at all.
    """
    missing = [(target, source) for target, source in _course_files(course) if not target.exists()]
    for target, source in missing:
        target.parent.mkdir(parents=True, exist_ok=True)
        part = target.with_name(f".{target.name}.part")
        shutil.copyfile(source, part)
        part.replace(target)
    return len(missing)


def _course_files(course: Path) -> Iterator[tuple[Path, Path]]:
    """Yield each file that a learner's course folder has, with the file that it is a copy of.

    Among them are the library's controllers, for reading: the notebooks point at them.
    """
    for source in SHIPPED.rglob("*"):
        if source.is_file() and source.suffix != ".pyc":  # pip compiles the launch files, too
            yield course / source.relative_to(SHIPPED), source
    for source in (PACKAGE / "controllers").glob("[a-z]*.py"):
        yield course / "tutorial" / "controllers" / source.name, source
