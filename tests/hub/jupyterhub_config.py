"""Configure a JupyterHub to try the course with ``make hub``. All users share a password and an account."""

import os
import shutil
import sys
from pathlib import Path

from jupyterhub.spawner import SimpleLocalProcessSpawner
from traitlets.config import get_config

CHECKOUT = Path(__file__).resolve().parents[2]
PROXY = CHECKOUT / ".venv/node_modules/.bin/configurable-http-proxy"
HOMES = Path("homes").resolve()  # below the folder in which the hub starts


def hand_out(spawner: SimpleLocalProcessSpawner) -> None:
    """Give a student the missing files of the course, and a private temporary folder."""
    home = Path(spawner.home_dir)
    (home / "tmp").mkdir(parents=True, exist_ok=True)
    for part in ("book", "launch_py", "notebooks", "project"):
        if not (home / part).exists():
            shutil.copytree(CHECKOUT / part, home / part)


c = get_config()
c.JupyterHub.authenticator_class = "shared-password"
c.SharedPasswordAuthenticator.user_password = os.environ["TANK_HUB_PASSWORD"]
c.SharedPasswordAuthenticator.allow_all = True
c.JupyterHub.spawner_class = SimpleLocalProcessSpawner
c.ConfigurableHTTPProxy.command = [str(PROXY)]
c.SimpleLocalProcessSpawner.home_dir_template = f"{HOMES}/{{username}}"
c.Spawner.cmd = [str(Path(sys.executable).parent / "tank"), "lab"]
c.Spawner.environment = {
    "TMPDIR": lambda spawner: f"{spawner.home_dir}/tmp",
    "TANK_TEST_MARK": os.environ.get("TANK_TEST_MARK", ""),  # tests find the processes by it
}
c.Spawner.default_url = "/lab/tree/notebooks/0_setup.ipynb"
c.Spawner.start_timeout = c.Spawner.http_timeout = 300  # [s]: all students start at the same time
c.Spawner.pre_spawn_hook = hand_out
