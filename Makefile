# `make demo` and `make test` set up all that they need; see README.md.
# Variables: PYTHON (the interpreter, 3.11 or newer), VENV (the folder of the
# virtual environment), ARGS (passed on, as in `make test ARGS=tests/core`).

VENV ?= .venv
BIN := $(VENV)/bin
ARGS ?=

.PHONY: demo test lint format types docs gallery conformance bench clean

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

gallery: $(VENV)/.dev
	$(BIN)/python docs/make_gallery.py $(ARGS)

conformance: $(VENV)/.dev
	$(BIN)/python docs/make_conformance.py

# Against a script that does the same with bare ModernGL and nothing else:
# make bench MODEL=helmet.gltf ENVIRONMENT=sky.hdr
bench: $(VENV)/.bench
	@test -n "$(MODEL)" -a -n "$(ENVIRONMENT)" || \
	    { echo "usage: make bench MODEL=file.gltf ENVIRONMENT=map.hdr"; false; }
	@mkdir -p build
	$(BIN)/python tests/benchmarks/compare.py $(ARGS) \
	    --name moka "$(BIN)/moka render $(MODEL) --size 1024x1024 \
	        --environment $(ENVIRONMENT) --no-cache -o build/moka.png" \
	    --name bare "$(BIN)/python tests/benchmarks/bare_moderngl.py \
	        $(MODEL) $(ENVIRONMENT) --size 1024x1024 -o build/bare.png"

# One stamp per set of extras; `pip` runs again only when the project file or
# the way to set up has changed.
$(VENV)/.%: pyproject.toml .ci/setup
	.ci/setup $(VENV) $*
	@touch $@

clean:
	rm -rf $(VENV) build dist site demo.png
	rm -rf .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -prune -exec rm -rf {} +
