PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PLUGINS := $(patsubst %/pyproject.toml,%,$(wildcard plugins/*/pyproject.toml))
# Two test processes share two cores: threads of linear algebra would only get in each other's way.
ONE_THREAD := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1

# Tests start many processes: each of them would compile every source again where no bytecode may be kept.
BYTECODE := PYTHONDONTWRITEBYTECODE=

.PHONY: help demo test tests test-long lint paper bench clean
help:
	@echo "make demo       simulate a drive, run a tournament, find a hidden effect"
	@echo "make test       lint, types and tests (under ten minutes on two cores)"
	@echo "make test-long  the tests that take longer"
	@echo "make paper      reproduce the 1997 paper into docs/paper.md"
	@echo "make bench      speed and accuracy beside other packages"

# One stamp: the environment is remade when what it is made from changes.
$(VENV)/.installed: pyproject.toml constraints.txt $(addsuffix /pyproject.toml,$(PLUGINS))
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]' $(addprefix -e ./,$(PLUGINS))
	touch $@

demo: $(VENV)/.installed
	$(BIN)/fricmodels demo

lint: $(VENV)/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/mypy $(addsuffix /src,$(PLUGINS))

# Lint and types are looked at while tests wait for what they have made hang.
test: $(VENV)/.installed
	@$(MAKE) --no-print-directory --jobs=2 lint tests

tests: $(VENV)/.installed
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null \
		|| echo "there is no Chromium: the tests of the report in a browser are skipped (apt-get install chromium)"
	$(BYTECODE) $(ONE_THREAD) $(BIN)/pytest -n 2 --dist worksteal -m "not long" tests plugins

test-long: $(VENV)/.installed
	$(BYTECODE) $(ONE_THREAD) $(BIN)/pytest -n 2 --dist worksteal -o faulthandler_timeout=3600 -m long tests plugins

paper: $(VENV)/.installed
	$(BIN)/python benchmarks/paper.py

bench: $(VENV)/.installed
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[bench]'
	$(BIN)/python benchmarks/filter_speed.py
	$(BIN)/python benchmarks/fit_speed.py
	$(BIN)/python benchmarks/hidden_effects.py --quick

clean:
	rm -rf $(VENV) build runs demo-run
