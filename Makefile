# Every target works on a fresh clone: each creates .venv and installs what it needs from the package index.
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt
JOBS ?= 2
# Where torch's build for CPUs is; its build on the package index brings gigabytes of CUDA on Linux. For a GPU, leave it
# empty (make install TORCH_INDEX=) or name another of torch's indexes. Where it cannot be reached, pip goes on with the
# package index that it is configured for.
TORCH_INDEX ?= https://download.pytorch.org/whl/cpu

.DEFAULT_GOAL := help
.PHONY: help install demo test check bench bench-full docs clean

help:  ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

.venv/pip: constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv .venv
	$(PIP) 'pip>=25.1'
	@touch $@

.venv/sim: .venv/pip pyproject.toml
	$(PIP) -e '.[sim]'
	@touch $@

# Torch alone, without what it needs: pip asks an extra index for each package of a command.
.venv/torch: .venv/sim
	$(PIP) --no-deps --retries 1 --timeout 30 $(if $(TORCH_INDEX),--extra-index-url $(TORCH_INDEX)) torch
	@touch $@

.venv/test: .venv/torch
	$(PIP) -e '.[sim,learn]' --group test
	@touch $@

.venv/dev: .venv/test
	$(PIP) --group dev
	@touch $@

.venv/all: .venv/dev
	$(PIP) -e '.[all]'
	@touch $@

install: .venv/all  ## create .venv with everything, torch and the developers' tools included

demo: .venv/sim  ## run the main job: ten LIBERO-Goal tasks, diagnosed, repaired and verified
	$(BIN)/onto demo

test: .venv/test  ## run all tests
	$(BIN)/python -m pytest -n $(JOBS) --dist loadfile

check: .venv/dev  ## format, lint, types, and the ontology
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/onto check
	$(BIN)/onto fmt --check ontology docs
	$(BIN)/onto schema --check
	$(BIN)/python -m benchmarks.tables --check

bench: .venv/test  ## every protocol, small
	$(BIN)/onto bench all

bench-full: .venv/test  ## the published figures; resumes what was interrupted
	$(BIN)/onto bench all --full

docs: .venv/test  ## write the generated tables of README.md and docs/results.md
	$(BIN)/python -m benchmarks.tables

clean:  ## remove what the other targets made, the environment included
	rm -rf .venv out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
