# The everyday commands, in a virtual environment of their own.
VENV := .venv
BIN := $(VENV)/bin

.PHONY: check test test-all test-quick snapshots docs site run measure dist

$(VENV)/ready: pyproject.toml
	python3 -m venv $(VENV)
	$(BIN)/pip install --quiet -e ".[test,dev]"
	touch $@

# What .ci/run asks for besides the tests
check: $(VENV)/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy --strict
	$(BIN)/mypy --strict --platform win32 --cache-dir .mypy_cache/win32
	$(BIN)/mypy --strict --platform darwin --cache-dir .mypy_cache/darwin
	$(BIN)/lint-imports
	$(BIN)/python tests/prose.py --check

test: $(VENV)/ready
	$(BIN)/python -m pytest

# Also every combination, size and damaged file
test-all: $(VENV)/ready
	$(BIN)/python -m pytest --all

# In a minute or so: what needs neither an app nor a child process, and a picture of each screen.
# With FOR=dyna-q the tests about that, slow ones too: the id of an algorithm, a policy or a
# scenario, a panel, or a module
test-quick: $(VENV)/ready
	$(BIN)/python -m pytest $(if $(FOR),-n 0 --for=$(FOR),-n 2 --quick)

# Look at every picture that changed before you keep it: docs/internals/tests.md says how.
# Only one process alone deletes pictures that no test draws any more
snapshots: $(VENV)/ready
	$(BIN)/python -m pytest tests/screen --all --snapshot-update -n 0

# What the documentation takes from the program: keys, commands, scenarios, agents
docs: $(VENV)/ready
	$(BIN)/python docs/generate.py

# The documentation as a site, in site/: nothing in it comes from elsewhere
site: $(VENV)/ready
	$(BIN)/python docs/build_site.py

run: $(VENV)/ready
	$(BIN)/rl-tui

# The timings that docs/internals/measured.md quotes; figures, not tests
measure: $(VENV)/ready
	$(BIN)/python tests/measure.py

# Wheel and sdist, with the time of the last commit in place of now: the same bytes on every machine
dist: export SOURCE_DATE_EPOCH := $(shell git log -1 --format=%ct)
dist: $(VENV)/ready
	rm -rf dist
	$(BIN)/python -m build
	$(BIN)/twine check --strict dist/*
