# Set-up, the main job, tests. `make help` lists the targets.
SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CORES ?= 2
export PATH := $(CURDIR)/$(BIN):$(PATH)

.DEFAULT_GOAL := help
.PHONY: help setup chair paper smoke report test bench mutation lint format schema lock clean

help:  ## List the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "make %-8s %s\n", $$1, $$2}'

setup: $(VENV)/installed  ## Create .venv with the locked dependencies and the package

$(VENV)/installed: requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "error: $(PYTHON) is older than 3.11; name a newer one: make setup PYTHON=python3.12" >&2; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	@touch $@

chair: setup  ## The main job: raw meshes in, results/tables/chair.csv out
	$(BIN)/snakemake --cores $(CORES) results/tables/chair.csv results/figures/chair/samples.png

paper: setup  ## Every table and figure that a config holds: make paper CONFIG=config/overnight.yaml
	$(BIN)/snakemake --cores $(CORES) $(if $(CONFIG),--configfile=$(CONFIG)) paper

smoke: setup  ## The same line on tiny data, in minutes, under results/smoke/
	$(BIN)/snakemake --cores $(CORES) --configfile=config/smoke.yaml results/smoke/tables/chair.csv

report: setup  ## What was made on one page that opens offline, report.html under results/: make report CONFIG=…
	$(BIN)/snakemake --cores $(CORES) $(if $(CONFIG),--configfile=$(CONFIG)) report_page

test: setup  ## Every test but the slow ones (those: make test PYTEST="-m slow")
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(CORES) --no-loadscope-reorder $(if $(PYTEST),$(PYTEST),-m "not slow")

bench: setup  ## Every benchmark: benchmarks/latest.json, docs/performance.md (at toy sizes: make bench BENCH=--quick)
	$(BIN)/python benchmarks/run.py $(BENCH)

mutation: setup  ## Change a module bit by bit and see whether its tests notice: make mutation MODULES=tetgan/evaluation/fid.py
	OMP_NUM_THREADS=1 $(BIN)/python benchmarks/mutation.py $(MODULES) --sample $(or $(SAMPLE),30)

lint: setup  ## Style, types, workflow lint, schema in step with the code
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/snakemake --lint
	$(BIN)/python -m tetgan.config --check workflow/schemas/config.schema.yaml

format: setup  ## Let ruff and snakefmt lay the code out
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/snakefmt Snakefile workflow

schema: setup  ## Write workflow/schemas/config.schema.yaml from the options classes
	$(BIN)/python -m tetgan.config --write workflow/schemas/config.schema.yaml

lock:  ## Resolve pyproject.toml anew and write requirements.lock
	rm -rf .venv-lock && $(PYTHON) -m venv .venv-lock
	.venv-lock/bin/python -m pip install --quiet torch==2.13.0
	.venv-lock/bin/python -m pip install --quiet --constraint requirements.in .[dev]
	( echo "# Written by 'make lock' on $$($(PYTHON) --version); torch brings its own CUDA packages where it has them."; \
	  .venv-lock/bin/python -m pip freeze --exclude tetgan | sed 's/+cpu$$//' | grep -v '^nvidia-\|^triton=='; \
	  echo "# A CUDA build of torch brings its own version; beside a CPU build the newest serves, interpreted."; \
	  echo "triton>=3.4; sys_platform == 'linux' and platform_machine == 'x86_64'" ) > requirements.lock
	rm -rf .venv-lock

clean:  ## Remove the environment; results stay
	rm -rf $(VENV)
