.DEFAULT_GOAL := help
.PHONY: help setup demo test nightly check docs bench clean

PYTHON ?= python3
BIN := .venv/bin

# Each of the many processes would compile the package again.
unexport PYTHONDONTWRITEBYTECODE

help: ## List the targets
	@grep -E '^[a-z]+:.*##' Makefile | sed -E 's/:.*## /\t/' | expand -t 8

setup: .venv/.ready ## Make .venv with the fingerpad command in it

# The lock file pins every package by hash, the build's own included, so that nothing is resolved here.
.venv/.ready: requirements.lock pyproject.toml tools/make-venv
	sh tools/make-venv "$(PYTHON)" .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

demo: setup ## Run the bundled study and write its report to demo-report/
	$(BIN)/fingerpad run examples/dzidek2017/study.toml --out demo-report

# Linear algebra takes one thread, as in the command line.
test nightly bench: export OMP_NUM_THREADS = 1

test: setup ## Run the tests, but for those of the night
	sh tools/find-chromium
	$(BIN)/python -m pytest -n auto --dist worksteal -m "not nightly"

nightly: setup ## Run all tests, those at size too, with new examples of Hypothesis
	sh tools/find-chromium
	HYPOTHESIS_PROFILE=nightly $(BIN)/python -m pytest -n auto --dist worksteal

check: setup ## Lint and type-check Python and the page's scripts, and check the layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	sh tools/check-page

docs: setup ## Build the documentation into docs/_build
	rm -rf docs/reference/_generated docs/gallery docs/tutorial/notebook
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs docs/_build/html

bench: setup ## Measure accuracy and speed and print the tables
	$(BIN)/python -m benchmarks all

clean: ## Remove everything that the other targets made
	rm -rf .venv node_modules build demo-report docs/_build docs/_static docs/gallery docs/tutorial/notebook docs/reference/_*.md docs/reference/_generated .pytest_cache .mypy_cache .ruff_cache .hypothesis dist
