"""Finds controllers: in the library, which has one controller per file, and in a user's file."""

import pkgutil
import sys
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from tutorial import controllers
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, describe_error, did_you_mean
from tutorial.system.paths import is_file


def controller_names() -> dict[str, str]:
    """Map the names of the library's controllers to their modules: ``TankController`` is in ``tank_controller.py``."""
    names = [module.name for module in pkgutil.iter_modules(controllers.__path__)]
    return {"".join(map(str.capitalize, name.split("_"))): f"{controllers.__name__}.{name}" for name in names}


def find_controller(name: str) -> type[SimpleController]:
    """Find one of the library's controllers by its class name.

    Raises:
        TutorialError: there is no such controller, or its file raises an exception; the message includes a similar name
            or the line number.
    """
    known = controller_names()
    if name not in known:
        raise TutorialError(f"there is no controller {name!r}.{did_you_mean(name, known)}")
    file = str(Path(controllers.__path__[0]) / f"{known[name].rpartition('.')[2]}.py")
    try:
        module = import_module(known[name])
    except Exception as error:
        if type(error).__name__ == "NeedsRealROSError":  # the real rclpy has no such exception to import
            from tutorial.ros.backend import real_ros_needed  # noqa: PLC0415 - the page that drives lacks this module

            raise real_ros_needed(name) from error
        raise TutorialError(describe_error(error, file)) from error
    found = _classes_of(module)
    if name not in found:
        rule = "A controller class must be named after its file: imu_publisher.py contains ImuPublisher."
        raise TutorialError(f"{file} has no class {name!r}.{did_you_mean(name, found)} {rule}")
    return found[name]


def load_controllers(path: Path, only: str | None = None) -> dict[str, type[SimpleController]]:
    """Run a user's file and return the controllers that it defines.

    Args:
        path: a Python file.
        only: return only the controller with this name; None for all.

    Returns:
        The classes by name.

    Raises:
        TutorialError: the file is missing, raises an exception, or does not define such a controller; the message
            includes the line number or a similar name.
    """
    if not is_file(path):
        others = [str(other) for other in path.parent.glob("*.py")]
        raise TutorialError(f"there is no file {str(path)!r}.{did_you_mean(str(path), others)}")
    spec = spec_from_file_location(f"own_controllers_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise TutorialError(f"{path} is not a Python file: its name does not end in '.py'.")
    module = sys.modules[spec.name] = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise TutorialError(describe_error(error, str(path.absolute()))) from error  # the path as tracebacks show it
    found = {name: each for name, each in _classes_of(module).items() if issubclass(each, SimpleController)}
    if not found:
        raise TutorialError(f"{path} defines no controller. A controller is a class derived from SimpleController.")
    if only is not None and only not in found:
        raise TutorialError(f"{path} defines no controller {only!r}.{did_you_mean(only, found)}")
    return found if only is None else {only: found[only]}


def _classes_of(module: ModuleType) -> dict[str, type]:
    """Return the classes that a module itself defines, by name."""
    return {n: c for n, c in vars(module).items() if isinstance(c, type) and c.__module__ == module.__name__}
