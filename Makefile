# `make reproduce` and `make test` are all a newcomer needs; both set up what they use.

ifeq (,$(wildcard .ci/setup))
$(error all paths are relative, and $(CURDIR) is not the folder of this Makefile: make -C FOLDER)
endif

PYTHON ?= python3
CORES := $(shell getconf _NPROCESSORS_ONLN)
# More than there are cores: tests wait for processes that they start.
JOBS ?= $(shell expr $(CORES) + 2)
REPRO ?=
EXAMPLES ?= 1000
SCENES ?= 5000

# The environment. Its place is relative, since make splits names at blanks.
BIN := .venv/bin
PY := $(BIN)/python

# The same order and width of floating-point operations on every x86 machine
# (src/granular_response/machine/floating_point.py, which the command line applies by itself).
export OPENBLAS_NUM_THREADS ?= 1
export OMP_NUM_THREADS ?= 1
ifneq (,$(filter x86_64 amd64,$(shell uname -m)))
export OPENBLAS_CORETYPE ?= Haswell
export NPY_DISABLE_CPU_FEATURES ?= X86_V4 AVX512_ICL AVX512_SPR
endif
# Settings of a user's shell or notebook do not reach what runs here, but for the places of caches.
unexport MPLBACKEND MATPLOTLIBRC
$(foreach name,$(filter-out PYTHON NUMBA_CACHE_DIR DVC_SITE_CACHE_DIR,$(filter PYTHON% NUMBA_% DVC_%,$(.VARIABLES))),$(eval unexport $(name)))
export DVC_NO_ANALYTICS := 1
# The stages of the pipeline call python and tools beside it.
export PATH := $(CURDIR)/$(BIN):$(PATH)

.DEFAULT_GOAL := help
.PHONY: help setup tools reproduce extensions figure survey test fuzz scenes coverage lint notebooks docs package wheels matrix
.PHONY: benchmark arena lock clean

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-11s %s\n", $$1, $$2} /^##/ {print "\n" substr($$0, 4)}' $(MAKEFILE_LIST)

## For readers of the paper

setup: ## Create .venv with the three packages and what they need, in the pinned versions (PYTHON=python3.12 picks another one)
	@$(call SETUP)

# As above, with tests, documentation and Dask besides, a third of the time of installing. xarray imports Dask wherever
# it is installed, which takes 0.2 s in every process.
tools:
	@$(call SETUP,--tools)

# Where the Python of .venv does not run, that of the user's PATH makes another one.
SETUP = for path in "$$PATH" "$${PATH\#*$(BIN):}"; do PATH=$$path; \
	test "$$("$(PYTHON)" -c 'import sys; print(sys.version_info >= (3, 11))' 2> /dev/null)" != True || \
	exec "$(PYTHON)" -I .ci/setup $(if $(filter command environment,$(firstword $(origin PYTHON))),--this-python) $(1); done; \
	echo "PYTHON=$(PYTHON): not there, or older than Python 3.11: make $(or $(MAKECMDGOALS),setup) PYTHON=python3.12" >&2; exit 1

reproduce: setup ## Rebuild what is out of date of the paper: simulations, figures, claims, page (REPRO=--force: everything)
	@$(PY) -P -m granular_response_paper reproduce $(REPRO)

extensions: setup ## The same for the questions beyond the paper, in the folder extensions/
	@$(PY) -P -m granular_response_paper reproduce --collection extensions $(REPRO)

figure: ## Draw one figure of the paper: make figure FIGURE=17, or one figure group: make figure GROUP=pile_dip
	@bash .ci/figure "$(GROUP)" "$(FIGURE)" > /dev/null
	@$(call SETUP)
	@$(PY) -P -m granular_response_paper reproduce --group $(DRAWN)
	@bash .ci/figure --drawn $(DRAWN)

# Without a shell around them commands get the signals that make gets.
DRAWN = $(shell bash .ci/figure "$(GROUP)" "$(FIGURE)" 2> /dev/null)

## For own work on it (docs/contributing.md has stress tests and comparisons besides)
survey: setup ## Run the large ensembles of disordered slabs and larger packings: 70 minutes on two cores; continues where it was
	$(PY) -P -m granular_response_paper.pipeline.dvc repro data/survey/dvc.yaml
	$(PY) data/survey/document.py

test: tools ## Run all tests (JOBS=2 for two processes)
	$(PY) -m pytest -n $(JOBS) --dist worksteal

fuzz: tools # Try every property on new random examples (EXAMPLES=5000 of each; `make test` tries the same 100)
	GRANULAR_RESPONSE_FUZZ=$(EXAMPLES) $(PY) -m pytest -m hypothesis -n $(JOBS)

scenes: tools # Solve and check SCENES=5000 random scenes, half of them of disks that differ by many decades (half an hour; goes on where it was interrupted)
	$(PY) -W ignore tests/unlike_scenes.py $(SCENES) --output tests/data/random_scenes.json

coverage: tools # What the unit tests reach but for compiled kernels; fails below the floor in pyproject.toml
	$(PY) -m coverage run -m pytest tests/unit
	$(PY) -m coverage report --show-missing --skip-covered

lint: tools ## Run the linters and the type checker
	$(PY) -m ruff check
	$(PY) -m mypy
	$(PY) $(BIN)/lint-imports

notebooks: tools ## Execute the notebooks of examples/notebooks anew, and store them with their outputs
	$(PY) tests/notebooks.py

docs: tools ## Build the documentation site into docs/_build/html, running every example of the gallery
	$(PY) -m sphinx -W --keep-going -q -b html docs docs/_build/html
	$(PY) .ci/links docs/_build/html

package: tools ## Build sdist and wheel, and try the wheel in a fresh environment
	bash .ci/package $(PY) $(PYTHON)

wheels: setup # Ask the package index whether each pinned package has a wheel for Python 3.11 to 3.14 (two minutes)
	bash .ci/wheels $(PY) 3.11 3.12 3.13 3.14

matrix: tools # The same for each of Python 3.11 to 3.13 that there is
	bash .ci/package $(PY) python3.11 python3.12 python3.13

benchmark: setup ## Time everything on this machine (benchmarks/dvc.yaml)
	$(PY) -P -m granular_response_paper.pipeline.dvc repro benchmarks/dvc.yaml

arena: setup # Steps and responses beside other codes that are installed; says how to install those that are not
	cd benchmarks && for name in kernel precision arena responses; do ../$(PY) -m peers.$$name peers/$$name.json || exit; done
	$(PY) benchmarks/document.py

lock: ## Renew requirements.lock with the newest versions that pyproject.toml allows
	$(PYTHON) -m venv --clear .venv-lock
	.venv-lock/bin/python -m pip install -qq hatchling editables ".[dask,docs,export,pipeline,test]" ./src/granular_response_paper
	{ sed -n '/^#/p' requirements.lock; \
	  .venv-lock/bin/python -m pip freeze --exclude granular-response --exclude granular-response-paper --exclude granular-response-extensions; } > requirements.lock.new
	mv requirements.lock.new requirements.lock
	rm -rf .venv-lock

clean: ## Remove .venv, caches and datasets; the DVC cache and the figures stay
	rm -rf .venv .venv-begun .venv-lock docs/_build docs/gallery .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis data/*.nc data/.rest_states data/.*.checkpoint extensions/data/*.nc extensions/data/.rest_states
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
