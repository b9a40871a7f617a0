# fogproof: every target makes the environment it needs; a fresh clone needs Python 3.11, git and make.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin

# Runs keep all cores busy with work of their own; threads inside small matrix products would only wait for each other.
export OPENBLAS_NUM_THREADS := 1

# Tests and runs start hundreds of processes: each would compile all of the sources anew.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help verify gallery study test lint format calibrate zoo repeat families oracle-docs docs sdist fuzz-oracle oracle-hard oracle-memory kill-study torture findings languages try-wheel golden bench mutants mutants-sample clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

verify: $(VENV)/.installed  ## every sampler and estimator, and its broken twin, against its reference; the page lands in build/report
	$(BIN)/fogproof verify --twins --report build/report

.PHONY: stability
stability: $(VENV)/.installed-test  ## formulas and samplers beside 50-digit truth in hard regions; the page lands in build/stability
	$(BIN)/fogproof stability -o build/stability

gallery: $(VENV)/.installed  ## the theory in pictures; the page lands in build/gallery
	$(BIN)/fogproof gallery -o build/gallery

test: $(VENV)/.installed-test  ## the project's own tests
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal

.PHONY: test-fresh
test-fresh: $(VENV)/.installed-test  ## the same with new seeds: a test that fails now and then has to be mended
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal --fresh

lint: $(VENV)/.installed-lint  ## ruff, mypy and the import contracts
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(VENV)/.installed-lint  ## let ruff rewrite what it can
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

calibrate: $(VENV)/.installed-test  ## how often the checks reject what is right; an hour, rewrites docs/calibration.md
	$(BIN)/python tools/calibrate.py

zoo: $(VENV)/.installed-test  ## known bugs against the checks and against other tests; an hour, resumable, rewrites docs/comparison.md
	$(BIN)/fogproof zoo --others -o build/zoo
	cp build/zoo/zoo.md docs/comparison.md

repeat: $(VENV)/.installed-test  ## 20 runs of the catalogue with fresh seeds: no false alarm
	$(BIN)/python tools/repeat_verify.py

.PHONY: images
images: $(VENV)/.installed-test  ## comparisons of images: false alarms, planted errors, size, broken files; an hour
	$(BIN)/python tools/image_promises.py planted
	$(BIN)/python tools/image_promises.py fuzz 2000
	$(BIN)/python tools/image_promises.py size
	$(BIN)/python tools/image_promises.py false-alarms 1000

families: $(VENV)/.installed-test  ## errors in a corner of a family's parameters: found and shrunk; right families: none rejected
	$(BIN)/python tools/families.py

oracle-hard: $(VENV)/.installed-test  ## every function of the oracle on 10^5 hard cases; rewrites docs/oracle-accuracy.md
	$(BIN)/python tools/oracle_hard.py --table docs/oracle-accuracy.md

oracle-memory: $(VENV)/.installed-test  ## which functions of the oracle take more memory the more numbers they are asked for
	$(BIN)/python tools/oracle_memory.py

oracle-docs: $(VENV)/.installed  ## write the tables of docs/oracle.md and the published schema anew
	$(BIN)/python tools/write_oracle_docs.py
	$(BIN)/fogproof oracle --schema > schemas/oracle-1.new && mv schemas/oracle-1.new schemas/oracle-1.json

fuzz-oracle: $(VENV)/.installed-test  ## 20000 broken lines to the oracle as a process: each costs its own answer and no other
	$(BIN)/python tools/fuzz_oracle.py

bench: $(VENV)/.installed-test  ## speed against error, every way to each number in turn; five minutes, rewrites docs/speed.md
	$(BIN)/fogproof bench -o build/bench
	cp build/bench/bench.md docs/speed.md

.PHONY: bench-more
bench-more: $(VENV)/.installed-test  ## what takes longer: studies, pipes, pages, paths, threads, memory of checks
	@for script in benchmarks/*.py; do echo "== $$script"; $(BIN)/python $$script || exit 1; done

study: $(VENV)/.installed  ## the lecture's estimators, speed against error; resumable, lands in runs/lecture
	$(BIN)/fogproof study studies/lecture.toml -o runs/lecture

kill-study: $(VENV)/.installed  ## kill a study at 20 random moments; nothing may be lost, and no bit may differ
	$(BIN)/python tools/kill_study.py

torture: $(VENV)/.installed-test  ## nothing lost, nothing silent: kills, full disks, flipped bits, broken lines, files and commands; long
	$(BIN)/python tools/torture_store.py
	$(BIN)/python tools/kill_study.py
	$(BIN)/python tools/fuzz_oracle.py
	$(BIN)/python tools/fuzz_oracle.py --lines 100000 --mostly-right
	$(BIN)/python tools/fuzz_files.py
	$(BIN)/python tools/fuzz_commands.py

findings: $(VENV)/.installed-test  ## what the checks found in Mitsuba, measured again without them; rewrites docs/findings.md
	$(BIN)/python tools/findings.py

languages: $(VENV)/.installed-test  ## the examples in C++, Rust, Go and JavaScript, right and broken, under 100 seeds
	$(BIN)/python tools/languages.py

try-wheel: $(VENV)/bin/python  ## the built wheel in a fresh environment: right samplers pass, wrong ones fail, in every way to run tests
	$(BIN)/python tools/try_wheel.py

golden: $(VENV)/.installed-test  ## prove the golden tables again, by ball arithmetic
	$(BIN)/python tools/make_golden.py --check

mutants: $(VENV)/.installed-test  ## realistic errors planted in our own source, one at a time: do the tests see them? hours, resumable
	$(BIN)/python tools/mutants --wide
	$(BIN)/python tools/mutants --table

mutants-sample: $(VENV)/.installed-test  ## thirty of them, drawn by SEED
	$(BIN)/python tools/mutants --sample 30 --seed $(or $(SEED),1)

docs: $(VENV)/.installed-docs  ## the documentation as a site that needs no network, in build/site
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict

sdist: $(VENV)/.installed-test  ## what is published, unpacked, passes its own tests
	rm -rf build/sdist && mkdir -p build/sdist
	$(BIN)/python -m pip install --quiet build
	$(BIN)/python -m build --sdist --outdir build/sdist .
	cd build/sdist && tar xzf *.tar.gz && cd fogproof-*/ && $(PYTHON) -m venv .venv && \
		.venv/bin/python -m pip install --quiet --upgrade 'pip>=25.1' && .venv/bin/python -m pip install --quiet . --group test && \
		.venv/bin/python -m pytest -q tests/oracle/test_transmittance.py tests/oracle/test_airlight.py tests/scene tests/house

clean:  ## remove the environment and everything built
	rm -rf $(VENV) build

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV) || { echo "python3 -m venv failed: on Debian, apt-get install python3-venv" >&2; exit 1; }
	$(BIN)/python -m pip install --quiet --upgrade 'pip>=25.1'

# An environment that was there may have an old pip, and a copy of fogproof: caches that its removal leaves would hide the sources.
$(VENV)/.installed: $(VENV)/bin/python pyproject.toml
	$(BIN)/python -m pip install --quiet --upgrade 'pip>=25.1'
	@$(BIN)/python -m pip uninstall --quiet --yes fogproof 2>/dev/null; rm -rf $(VENV)/lib/python3.*/site-packages/fogproof
	$(BIN)/python -m pip install --quiet --editable '.[mie,mitsuba,images]'
	@touch $@

$(VENV)/.installed-test: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --group test
	@touch $@

$(VENV)/.installed-docs: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --group docs
	@touch $@

$(VENV)/.installed-lint: $(VENV)/.installed-test
	$(BIN)/python -m pip install --quiet --group lint
	@touch $@
