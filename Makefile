# Each target makes .venv when it is missing and reuses it; nothing else has to be installed first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: demo test lint wheel-check bench agreement singularities census policy report gallery screenshot clean

demo: $(READY)
	@$(BIN)/python benchmarks/demo.py

# A process a core: threads of the linear algebra would only wait for each other.
test: $(READY)
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --dist loadfile

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

wheel-check: $(READY)
	PYTHON=$(PYTHON) bash tests/wheel_check.sh $(BIN)/python

bench: $(READY)
	$(BIN)/python benchmarks/latency.py
	$(BIN)/python benchmarks/batch.py
	$(BIN)/python benchmarks/singular.py
	$(BIN)/python benchmarks/torques.py
	$(BIN)/python benchmarks/inverse.py
	$(BIN)/python benchmarks/check.py
	$(BIN)/python benchmarks/sweep.py

agreement: $(READY)
	$(BIN)/python benchmarks/agreement.py

singularities: $(READY)
	$(BIN)/python docs/singularities.py

policy: $(READY)
	$(BIN)/python -m kinetostat.policy.schema
	$(BIN)/python docs/policy.py

census: $(READY)
	$(BIN)/python docs/census.py

report: $(READY)
	$(BIN)/python -m kinetostat.report.fleet.schema
	$(BIN)/python docs/report.py

gallery: $(READY)
	$(BIN)/python docs/gallery.py

screenshot: $(READY)
	$(BIN)/python docs/screenshot.py

clean:
	rm -rf $(VENV) dist build .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache

# compileall: where Python is told not to write bytecode, every start would compile the sources again.
$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "kinetostat needs Python 3.11 or later"; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "installing into $(VENV) (once, about a minute) ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev]'
	@$(BIN)/python -m compileall -q src cli
	@touch $@
