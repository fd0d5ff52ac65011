# Everything is set up by the project itself: a virtual environment in .venv with the versions of constraints.txt.
PYTHON ?= python3.11
BIN := .venv/bin
STAMP := .venv/.installed

.PHONY: demo figures test lint crosscheck certify bench docs clean
.DEFAULT_GOAL := help

help:  ## this list
	@sed -n 's/^\([a-z]*\):.*## /\1: /p' Makefile

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[dev]"
	@touch $@

demo: $(STAMP)  ## render the lecture's pictures and its central plot into demo/index.html (under 5 minutes)
	$(BIN)/python -m raylab.demo

figures: $(STAMP)  ## make every figure of docs/gallery.md
	$(BIN)/python -m raylab.cli figures -o docs/figures --gallery docs/gallery.md

test: $(STAMP) lint  ## all tests, compiled and in plain Python (under 12 minutes on two cores)
	$(BIN)/python -m pytest $(ON_TWO_CORES) -m "not crosscheck and not certify"
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m pytest $(ON_TWO_CORES) -m "not crosscheck and not certify" $(PLAIN)

lint: $(STAMP)  ## ruff and mypy
	$(BIN)/ruff check raylab tests reference_scenes
	$(BIN)/ruff format --check raylab tests reference_scenes
	$(BIN)/mypy

crosscheck: $(STAMP)  ## compare with Mitsuba 3, pixel by pixel (installs it)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[crosscheck]"
	$(BIN)/python -m pytest -m crosscheck

certify: $(STAMP)  ## false alarms, power and planted mistakes of the tests: docs/certificate.md (goes on where it was stopped)
	$(BIN)/python -m pytest -n 2 -m certify
	PYTHONPATH=tests $(BIN)/python -m mutants.certify

bench: $(STAMP)  ## measure the numbers of docs/performance.md on this machine
	$(BIN)/python tests/benchmarks/all.py

docs: $(STAMP)  ## the documentation as HTML pages in docs/_build
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[docs]"
	$(BIN)/python -m sphinx -q -b html docs docs/_build

clean:  ## remove what the targets above have made
	rm -rf .venv demo docs/_build build *.egg-info .pytest_cache .mypy_cache .ruff_cache

# Each file runs on one core, so that its kernels are compiled once; tests/conftest.py says which files begin.
ON_TWO_CORES := -n 2 --dist loadfile --no-loadscope-reorder

# The test files that also run without the compiler: the same source in plain Python, at small sizes.
PLAIN := $(addprefix tests/test_,$(addsuffix .py,twin vec3 record rng lanes samplers sobol sampling fresnel brdf \
	lights light_table environment image_environment quadrics camera materials textures geometry microfacet rough glossy basic))
