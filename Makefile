# One verb a command. A newcomer needs two: `make demo` and `make test`.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready

.PHONY: help demo paper test check check-all lint types layers format recompile clean
.DEFAULT_GOAL := help

help: ## list the verbs
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade -c constraints.txt pip
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e . --group dev
	@touch $(READY)

demo: $(READY) ## set up, then go from a generated CT to the report in demo/
	$(BIN)/auricle phantom -o demo/scan --preset small --seed 1
	$(BIN)/auricle analyze demo/scan/volume.nrrd -o demo/report
	@echo "Open demo/report/report.html"

# Where the real atria lie; without them the study is done on the generated ones.
paper: export AURICLE_DATA ?= $(abspath $(wildcard ../shared/data))
paper: $(READY) ## set up, then the paper's study from nothing into paper/ (under an hour on two cores)
	$(BIN)/auricle study examples/studies/paper.toml -o paper --workers 2
	cp paper/reproduction.md docs/reproduction.md
	@echo "Open paper/report.html"

test: $(READY) ## set up, then run the tests
	$(BIN)/python -m pytest -n 2 --dist loadfile

check: lint types layers test ## everything CI runs

check-all: lint types layers ## the same with the slow tests
	$(BIN)/python -m pytest -n 2 --dist loadfile -m "slow or not slow"

lint: $(READY) ## style, by ruff
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

types: $(READY) ## mypy --strict
	$(BIN)/mypy

layers: $(READY) ## the import contract
	$(BIN)/lint-imports

format: $(READY) ## let ruff lay out the code
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

recompile: ## forget compiled functions, which are kept until their own file changes
	find src -name '*.nb[ic]' -delete

clean: ## remove what the verbs made
	rm -rf .venv demo paper build dist
