# SPDX-License-Identifier: Apache-2.0
#
# Thin: the work and the progress lines are in tools/build.py, the test suites in tools/run_tests.py.

PYTHON ?= python3
PORT ?= 8080
# How long `make demo` serves, in seconds; without it, until Ctrl-C. Not taken from the environment: bash has a SECONDS.
ifneq ($(origin SECONDS),command line)
SECONDS :=
endif
# Which suites `make test` and `make test-all` run; all when empty. `make test SUITES="cpp python"`
SUITES ?=
# Arguments of bench/run_bench.py, `iota verify` and tools/soak.py.
BENCH ?=
VERIFY ?=
SOAK ?=
# How many damaged snapshots, and recordings of each of five kinds, `make hostile` tries, and from which seed.
HOSTILE ?= 10000
SEED ?= 1
# Which studies `make films` records; all when empty. `make films FILMS="chain cradle"`
FILMS ?=

iota = .venv/bin/iota
cpp_presets = debug sanitized tsan coverage strict

.DEFAULT_GOAL := help
.PHONY: help build demo films test test-all bench verify soak hostile check-determinism wheel sbom docs format lint tidy clean distclean $(addprefix check-,$(cpp_presets))

help: ## what there is to make (this list)
	@awk 'BEGIN { FS = ":.*## " } /^[a-z-]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)
	@echo "  make check-X    C++ tests under a preset: $(cpp_presets)"

build: ## install what is missing, build engine, bindings and page; the command line is .venv/bin/iota
	@$(PYTHON) tools/build.py build

demo: ## build, then serve the gallery of all studies and print its address (PORT=8080, SECONDS= to stop by itself)
	@$(PYTHON) tools/build.py build
	@exec $(iota) gallery --port $(PORT) $(if $(SECONDS),--seconds $(SECONDS))

films: ## build, then record every study: build/films, docs/pictures/studies (FILMS="chain cradle" for some)
	@$(PYTHON) tools/build.py films
	@.venv/bin/python tools/make_films.py $(FILMS)

test: ## build, then run the tests of every language; a tenth of what only samples (SUITES="cpp python" for some)
	@$(PYTHON) tools/build.py test
	@.venv/bin/python tools/run_tests.py $(SUITES)

test-all: ## the same with all samples, the wheels of all Pythons here, and with suites whose inputs have not changed
	@$(PYTHON) tools/build.py test-all
	@.venv/bin/python tools/run_tests.py --all $(SUITES)

bench: ## build, then measure engine, packaged peers, server and page in one run (BENCH="--quick")
	@$(PYTHON) tools/build.py bench
	@.venv/bin/python bench/run_bench.py $(BENCH)
	@.venv/bin/npm --prefix web run --silent capacity
	@.venv/bin/python bench/contact_bench.py
	@.venv/bin/python bench/edit_cost.py
	@.venv/bin/python bench/sweep_cost.py
	@.venv/bin/python bench/rooms_load.py --rooms 20
	@.venv/bin/npm --prefix web run --silent bench

verify: ## build, compare with what is known, renew docs/verification.md (VERIFY="--quick")
	@$(PYTHON) tools/build.py verify
	@$(iota) verify $(VERIFY)

soak: ## build, then for some hours: random scenes, promises of motion, edits by the million, levels and sleep of ten thousand scenes, linkages and studies for ten minutes, random messages to each study, a thousand kills of kept worlds, an open page for thirty (SOAK="scenes edits")
	@$(PYTHON) tools/build.py soak
	@.venv/bin/python tools/soak.py $(SOAK)

hostile: ## damaged snapshots and recordings under sanitizers, up to half an hour (HOSTILE=100000 SEED=2)
	@$(PYTHON) tools/build.py cpp --preset sanitized
	@IOTA_HOSTILE_COUNT=$(HOSTILE) IOTA_HOSTILE_SEED=$(SEED) build/sanitized/iota_tests --gtest_brief=1 --gtest_filter='Restore.*:*DamagedRecording.*'

check-determinism: ## the same bits from gcc and clang at -O1 and -O3
	@$(PYTHON) tools/check_determinism.py

wheel: ## build/wheel/*.whl, one for each supported Python here, with engine, server, page and OpenSSL, as PyPI takes it
	@$(PYTHON) tools/build.py wheel

sbom: ## the bill of materials of the wheel: build/sbom/*.cdx.json (CycloneDX)
	@$(PYTHON) tools/build.py sbom

docs: ## a site with search of all documents, the Python and the C++ reference: build/docs/site/index.html
	@$(PYTHON) tools/build.py docs
	@echo build/docs/site/index.html

format: ## format C++ and Python
	@$(PYTHON) tools/build.py lint
	@.venv/bin/python tools/lint.py --format

lint: ## check formatting, types and style of every language; print the folder graph
	@$(PYTHON) tools/build.py lint
	@.venv/bin/python tools/lint.py

tidy: ## clang-tidy over all C++ (minutes)
	@$(PYTHON) tools/build.py test
	@$(PYTHON) tools/build.py lint
	@.venv/bin/python tools/lint.py --tidy

clean: ## remove what was built (keeps .venv and web/node_modules)
	rm -rf build web/dist web/dist.new web/dist.old web/src/protocol/generated.ts python/iota/_core.* python/iota/page

distclean: clean ## remove everything that make made
	rm -rf .venv web/node_modules

$(addprefix check-,$(cpp_presets)): check-%:
	@$(PYTHON) tools/build.py cpp --preset $*
	@build/$*/iota_tests --gtest_brief=1
