"""Measure memory and processor time of each student of a JupyterHub, in notebook 1. ``make hub-load USERS=30``.

Each student logs in, runs the notebook until its tank runs, and closes the page. This program then measures the tank
while it runs unwatched, the same tank at rest, and the memory of the student's server, kernel and other processes,
with shared memory divided equally between them (PSS).
"""

import statistics
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from hub import Student, cells, hub
from rich.console import Console
from rich.table import Table

MEASURED = 20.0  # [s]
LEAVE = "import tutorial.notebook.program as module\nmodule.REST_AFTER = {}"
GONE = "program._started_at = module.CellWidget.heard_at = 0.0"  # as if it had been gone since the machine started
BACK = "module.CellWidget.heard_at = module.math.inf\nprogram.start()"
FOREVER = 1e9


def seconds(student: Student) -> float:
    """Return the processor time that the student's processes have used so far [s]."""
    return sum(sum(process.cpu_times()[:2]) for process in student.processes())


def loads(students: list[Student]) -> list[float]:
    """Return the share of a core that each student's processes use [%]."""
    began, before = time.monotonic(), [seconds(student) for student in students]
    time.sleep(MEASURED)
    after, took = [seconds(student) for student in students], time.monotonic() - began
    return [100 * (now - then) / took for now, then in zip(after, before)]


def times(pool: ThreadPoolExecutor, students: list[Student]) -> list[list[float]]:
    """Return the time in each student's simulation, and on the machine [s]."""
    ask = "print(program.simulation.time, module.time.monotonic())"
    return [[*map(float, said.split())] for said in pool.map(lambda student: student.run(ask), students)]


def memory(student: Student) -> float:
    """Return the memory that the student's processes use [MB]."""
    return sum(process.memory_full_info().pss for process in student.processes()) / 1e6


def attend(student: Student) -> str:
    """Run the notebook until its tank runs, look at it, and close the page; return the kernel's ROS domain."""
    for cell in cells()[0]:
        student.run(cell)
    student.run(LEAVE.format(FOREVER))
    view = student.run("print(program.view.comm.comm_id)").strip()
    for word in ("hello", "bye"):
        student.look(view, word)
    return student.run(f"{GONE}\nimport os\nprint(os.environ['ROS_DOMAIN_ID'])").strip()


def rest(student: Student) -> None:
    """Let the tank rest, as it does some minutes after its page was closed."""
    student.run(LEAVE.format(0) + "\nawait until(lambda: not program.simulation.running)")


def finish(student: Student) -> None:
    """Run the remaining cells."""
    student.run(f"{LEAVE.format(FOREVER)}\n{BACK}")
    for cell in cells()[1]:
        student.run(cell)


def main(users: int) -> None:
    """Measure everything and print a table."""
    began = time.monotonic()
    with (
        tempfile.TemporaryDirectory(prefix="hub-") as folder,
        hub(Path(folder)) as at,
        ThreadPoolExecutor(users) as pool,
    ):
        students = list(pool.map(lambda number: Student(at, f"student{number}"), range(users)))
        domains = set(pool.map(attend, students))
        print(f"{users} students, {len(domains)} domains, all tanks running after {time.monotonic() - began:.0f} s")
        before, running, after = times(pool, students), loads(students), times(pool, students)
        paces = [100 * (now[0] - then[0]) / (now[1] - then[1]) for now, then in zip(after, before)]
        list(pool.map(rest, students))
        resting, megabytes = loads(students), [memory(student) for student in students]
        list(pool.map(finish, students))
        print(f"all notebooks have finished after {time.monotonic() - began:.0f} s")
    table = Table("of each student", "least", "median", "most")
    rows = {
        "memory [MB]": megabytes,
        "unwatched, running [% of a core]": running,
        "its time [% of real time]": paces,
        "at rest [% of a core]": resting,
    }
    for name, values in rows.items():
        table.add_row(name, *(f"{value:.1f}" for value in (min(values), statistics.median(values), max(values))))
    Console().print(table)


if __name__ == "__main__":
    main(int(sys.argv[1]))
