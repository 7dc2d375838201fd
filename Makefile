# `make demo` and `make test` set up all that they need; see README.md.
# Variables: PYTHON (the interpreter, 3.11 or newer), VENV (the folder of the
# virtual environment), ARGS (passed on, as in `make test ARGS=tests/core`).

VENV ?= .venv
BIN := $(VENV)/bin
ARGS ?=

.PHONY: demo test lint format types docs bench clean

demo: $(VENV)/.dev
	$(BIN)/moka render -o demo.png $(ARGS)
	@echo "wrote demo.png"

test: $(VENV)/.dev
	$(BIN)/python -m pytest $(ARGS)

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

format: $(VENV)/.dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

types: $(VENV)/.dev
	$(BIN)/mypy

docs: $(VENV)/.docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

bench: $(VENV)/.bench
	$(BIN)/python -m pytest tests/benchmarks $(ARGS)

# One stamp per set of extras; `pip` runs again only when the project file or
# the way to set up has changed.
$(VENV)/.%: pyproject.toml .ci/setup
	.ci/setup $(VENV) $*
	@touch $@

clean:
	rm -rf $(VENV) build dist site demo.png
	rm -rf .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -prune -exec rm -rf {} +
