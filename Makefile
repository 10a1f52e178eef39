# make study: from a study file to its report.  make test: the tests.  Both set up .venv first when needed.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.ready
STUDY ?= config/studies/default.yaml
CORES ?= all

.PHONY: env study test lint test-slurm test-long clean-results

env: $(STAMP)

$(STAMP): requirements.lock pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --disable-pip-version-check -q -r requirements.lock
	$(BIN)/python -m pip install --disable-pip-version-check -q --no-deps --no-build-isolation -e .
	$(BIN)/python -c "import trackroller as tr; tr.solve(tr.Case(), outputs=('friction_work', 'life', 'tractions', 'subsurface'))"  # compiles once
	touch $@

study: $(STAMP)
	$(BIN)/snakemake --cores $(CORES) --config study=$(STUDY)

test: $(STAMP)
	$(BIN)/python -m pytest -q -n 2 --dist loadfile

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/snakefmt --check Snakefile workflow/rules validation/Snakefile validation/rules
	$(BIN)/snakemake --lint

# needs Debian's slurmctld slurmd slurm-client munge on this machine; starts and stops its own
test-slurm: $(STAMP)
	$(BIN)/python -m pytest -q -m slurm tests/workflow/test_workflow_slurm.py

test-long: $(STAMP)
	$(BIN)/python -m validation.benchmarks.survive

clean-results:
	find results -mindepth 1 -maxdepth 1 -type d -exec rm -r {} +
