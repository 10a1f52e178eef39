# make study: from a study file to its report.  make test: the tests.  Both set up .venv first when needed.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.ready
CI_STAMP := $(VENV)/.ci-ready
STUDY ?= config/studies/default.yaml
CORES ?= all
SNAKEFILES := Snakefile workflow/Snakefile workflow/rules validation/Snakefile
# what another version of Python may change: syntax trees, files, processes, imports; a solution, a study, the workflow
INTERPRETER := tests/numerics tests/parameters tests/study/file tests/cli/test_cli.py tests/cli/test_file_names.py \
	tests/study/test_resume.py tests/roller/test_solver.py tests/test_environment.py tests/workflow/test_workflow.py

# Snakemake needs a home that can be written and the name of a user; a container or a cluster may give neither
ifeq ($(shell [ -n "$$HOME" ] && [ -d "$$HOME" ] && [ -w "$$HOME" ] && echo yes),)
export HOME := $(shell mktemp -d)
$(info HOME cannot be written, so the caches of this run stand in $(HOME))
endif
export USER := $(or $(USER),$(LOGNAME),$(shell id -u))

# an environment that forbids bytecode would have each process compile each module anew
unexport PYTHONDONTWRITEBYTECODE

.PHONY: env env-ci lock study validate test test-python test-browser lint docs explorer explorer-check test-slurm test-long clean-results

env: $(STAMP)

# pins every package with its hashes; needs uv (pip install uv) and a network
COMPILE := uv pip compile --python-version 3.11 --universal --generate-hashes --no-annotate --no-header -q
lock:
	$(COMPILE) --all-extras pyproject.toml requirements.in -o requirements.lock
	$(COMPILE) requirements-ci.in -c requirements.lock -o requirements-ci.lock
	$(BIN)/python docs/licences.py --write

$(STAMP): requirements.lock pyproject.toml
	@echo "Setting up $(VENV): this happens once and takes some minutes."
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --disable-pip-version-check -q --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --disable-pip-version-check -q --no-deps --no-build-isolation -e .
	@echo "Compiling the solver: about a minute, once."
	$(BIN)/python -c "import trackroller as tr; tr.solve(tr.Case(), outputs=('friction_work', 'life', 'tractions', 'subsurface'))"
	touch $@

# what the site, its tests and CI need beyond it
env-ci: $(CI_STAMP)

$(CI_STAMP): $(STAMP) requirements-ci.lock
	$(BIN)/python -m pip install --disable-pip-version-check -q --require-hashes -r requirements-ci.lock
	touch $@

# ends with the path of the report and how long it took; --quiet shows progress in cases and errors, nothing else
study: $(STAMP)
	$(BIN)/snakemake --quiet progress host --cores $(CORES) --config study=$(STUDY)

# the evidence: edge cases, trade-off, the paper, contact models side by side, other programs, the table, benchmarks
validate: $(STAMP)
	$(BIN)/snakemake -s validation/Snakefile --quiet rules host --cores $(CORES)

# the tests of a second or two, in four minutes; CI runs the slow ones and those in a browser as well
test: $(CI_STAMP)
	$(BIN)/python -m pytest -q -ra -n 2 --dist worksteal

# another version of Python runs these tests, which depend on it
test-python: $(STAMP)
	$(BIN)/python -m pytest -q -ra -n 2 --dist worksteal $(wildcard $(INTERPRETER))

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/snakefmt --check $(SNAKEFILES)
	$(BIN)/snakemake --lint
	$(BIN)/snakemake -s validation/Snakefile --lint

# the site in site/: generated pages must be up to date, and no link may be dead
docs: $(CI_STAMP)
	$(BIN)/python docs/generate.py --check
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

# the pages in a browser; needs Chromium, and axe-core from `npm ci` in web/
test-browser: $(CI_STAMP)
	$(BIN)/python -m pytest -q -ra -n 2 --dist worksteal -m browser tests/report tests/docs tests/app

# the script of the explorer from web/src, which needs Node and npm; the check compares it byte for byte
explorer:
	cd web && npm ci --ignore-scripts --no-audit --no-fund && node build.mjs

explorer-check:
	cd web && node build.mjs --check

# needs Debian's slurmctld slurmd slurm-client munge on this machine; starts and stops its own
test-slurm: $(STAMP)
	$(BIN)/python -m pytest -q -m slurm tests/workflow/test_workflow_slurm.py

# the slow and the long tests, with 200 interrupted and 200 killed commands, 600 extremes and 10,000 generated inputs
test-long: $(STAMP)
	EDITS=10000 INTERRUPT_TRIES=200 EXTREME_FIFTIES=12 $(BIN)/python -m pytest -q -ra -n 2 --dist worksteal -m "slow or long"
	TRACKROLLER_EXAMPLES=10000 $(BIN)/python -m pytest -q -n 2 tests/cli/test_refusals.py tests/cli/test_fuzz.py

clean-results:
	find results -mindepth 1 -maxdepth 1 -type d -exec rm -r {} +
