# `make reproduce` and `make test` are all a newcomer needs; both set up what they use.

PYTHON ?= python3
CORES := $(shell getconf _NPROCESSORS_ONLN)
# More than there are cores: tests wait for processes that they start.
JOBS ?= $(shell expr $(CORES) + 2)
REPRO ?=
EXAMPLES ?= 1000
BROKEN ?= 10000
SCENES ?= 5000

VENV := $(CURDIR)/.venv
BIN := $(VENV)/bin
PAPER := $(VENV)/.paper
TOOLS := $(VENV)/.tools

# The same order and width of floating-point operations on every x86 machine
# (src/granular_response/machine/floating_point.py, which the command line applies by itself).
export OPENBLAS_NUM_THREADS ?= 1
export OMP_NUM_THREADS ?= 1
ifneq (,$(filter x86_64 amd64,$(shell uname -m)))
export OPENBLAS_CORETYPE ?= Haswell
export NPY_DISABLE_CPU_FEATURES ?= X86_V4 AVX512_ICL AVX512_SPR
endif
export DVC_NO_ANALYTICS := 1
# Some environments ask Python to keep no bytecode. Hundreds of short processes would each compile the package anew.
unexport PYTHONDONTWRITEBYTECODE
# The stages of the pipeline call granular-response-paper and tools beside it.
export PATH := $(BIN):$(PATH)

.DEFAULT_GOAL := help
.PHONY: help setup reproduce extensions figure survey test fuzz broken scenes coverage lint notebooks docs package matrix
.PHONY: benchmark arena lock clean

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-11s %s\n", $$1, $$2} /^##/ {print "\n" substr($$0, 4)}' $(MAKEFILE_LIST)

## For readers of the paper

setup: $(PAPER) ## Create .venv with the three packages and what they need, in the pinned versions (PYTHON=python3.12 picks another one)

INSTALL = "$(BIN)/python" -m pip install -qq --disable-pip-version-check --constraint requirements.lock

$(PAPER): requirements.lock pyproject.toml src/granular_response_paper/pyproject.toml extensions/pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "$(PYTHON) is older than Python 3.11: make setup PYTHON=python3.12" >&2; exit 1; }
	@echo "Installing the pinned versions into .venv (a minute or two the first time)"
	@test -x "$(BIN)/python" || $(PYTHON) -m venv "$(VENV)"
	@$(INSTALL) hatchling editables
	@$(INSTALL) --no-build-isolation -e ".[export,pipeline]" -e src/granular_response_paper -e extensions
	@touch "$@"

# Tests, documentation and Dask: a third of the time of installing. xarray imports Dask wherever it is installed, which
# takes 0.2 s in every process.
$(TOOLS): $(PAPER)
	@echo "Installing the tools of development into .venv"
	@$(INSTALL) -r requirements.lock
	@touch "$@"

reproduce: setup ## Rebuild what is out of date of the paper: simulations, figures, claims, page (REPRO=--force: everything)
	@test -e .git || "$(BIN)/dvc" config --local core.no_scm true
	@"$(BIN)/granular-response-paper" reproduce $(REPRO)

extensions: setup ## The same for the questions beyond the paper, in the folder extensions/
	@test -e .git || "$(BIN)/dvc" config --local core.no_scm true
	@"$(BIN)/granular-response-paper" reproduce --collection extensions $(REPRO)

figure: ## Draw one figure of the paper: make figure FIGURE=17, or one figure group: make figure GROUP=pile_dip
	@.ci/figure "$(GROUP)" "$(FIGURE)" > /dev/null
	@$(MAKE) --no-print-directory setup
	@test -e .git || "$(BIN)/dvc" config --local core.no_scm true
	@group=$$(.ci/figure "$(GROUP)" "$(FIGURE)") && "$(BIN)/dvc" repro --quiet draw@$$group < /dev/null && .ci/figure --drawn $$group

## For own work on it
survey: setup ## Run the large ensembles of disordered slabs and larger packings: 70 minutes on two cores; continues where it was
	@test -e .git || "$(BIN)/dvc" config --local core.no_scm true
	"$(BIN)/dvc" repro survey/dvc.yaml
	"$(BIN)/python" survey/document.py

test: $(TOOLS) ## Run all tests and the linters (JOBS=2 for two processes)
	@test -e .git || "$(BIN)/dvc" config --local core.no_scm true
	"$(BIN)/python" -m pytest -n $(JOBS) --dist worksteal

fuzz: $(TOOLS) ## Try every property on new random examples (EXAMPLES=5000 of each; `make test` tries the same 100)
	GRANULAR_RESPONSE_FUZZ=$(EXAMPLES) "$(BIN)/python" -m pytest -m hypothesis -n $(JOBS)

broken: $(TOOLS) ## Cut and change files of all formats at random, BROKEN=10000 of them, and see what reads them (ten minutes)
	PYTHONPATH=tests "$(BIN)/python" tests/integration/broken_files.py $(BROKEN) --output tests/data/broken_files.json

scenes: $(TOOLS) ## Solve and check SCENES=5000 random scenes, half of them of disks that differ by many decades (half an hour; goes on where it was interrupted)
	"$(BIN)/python" -W ignore tests/unlike_scenes.py $(SCENES) --output tests/data/random_scenes.json

coverage: $(TOOLS) ## What the unit tests reach but for compiled kernels; fails below the floor in pyproject.toml
	"$(BIN)/coverage" run -m pytest tests/unit
	"$(BIN)/coverage" report --show-missing --skip-covered

lint: $(TOOLS) ## Run the linters and the type checker alone
	"$(BIN)/ruff" check
	"$(BIN)/mypy"
	"$(BIN)/lint-imports"

notebooks: $(TOOLS) ## Execute the notebooks of examples/notebooks anew, and store them with their outputs
	"$(BIN)/python" tests/notebooks.py

docs: $(TOOLS) ## Build the documentation site into docs/_build/html, running every example of the gallery
	"$(BIN)/python" -m sphinx -W --keep-going -q -b html docs docs/_build/html
	"$(BIN)/python" .ci/links docs/_build/html

package: $(TOOLS) ## Build sdist and wheel, and try the wheel in a fresh environment
	.ci/package "$(BIN)/python" "$(PYTHON)"

matrix: $(TOOLS) ## The same for each of Python 3.11 to 3.13 that there is
	.ci/package "$(BIN)/python" python3.11 python3.12 python3.13

benchmark: setup ## Time everything on this machine (benchmarks/dvc.yaml)
	"$(BIN)/dvc" repro benchmarks/dvc.yaml

arena: setup ## Steps, responses and bounces beside other codes that are installed; says how to install those that are not
	cd benchmarks && for name in bounces arena responses; do "$(BIN)/python" -m peers.$$name peers/$$name.json || exit; done
	"$(BIN)/python" benchmarks/document.py

lock: ## Renew requirements.lock with the newest versions that pyproject.toml allows
	$(PYTHON) -m venv --clear "$(VENV)-lock"
	"$(VENV)-lock/bin/python" -m pip install -qq hatchling editables ".[dask,docs,export,pipeline,test]" \
	  ./src/granular_response_paper
	{ sed -n '/^#/p' requirements.lock; \
	  "$(VENV)-lock/bin/python" -m pip freeze --exclude granular-response --exclude granular-response-paper --exclude granular-response-extensions; } > requirements.lock.new
	mv requirements.lock.new requirements.lock
	rm -rf "$(VENV)-lock"

clean: ## Remove .venv, caches and datasets; the DVC cache and the figures stay
	rm -rf .venv .venv-lock docs/_build docs/_drawn docs/gallery .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis data/*.nc data/.rest_states data/.*.checkpoint extensions/data/*.nc extensions/data/.rest_states
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
