# SPDX-License-Identifier: BSD-3-Clause
# The two commands of the README are `make demo` and `make test`; each does all its set-up. The build itself is Meson's.
BUILD ?= build
PREFIX ?= /usr/local
DESTDIR ?=
MESON_OPTIONS ?=

.PHONY: all build deps demo test test-all bench install uninstall docs man format check-format check fuzz asan clean help

all: build

help:
	@echo 'make            build a release into $(BUILD)/ (installs missing packages with apt where it may)'
	@echo 'make deps       that installing alone'
	@echo 'make demo       build, run the demonstration, say where its page is'
	@echo 'make test       build and pass the tests; test-all: the slow ones as well'
	@echo 'make bench      all benchmarks, as JSON lines in $(BUILD)/bench/'
	@echo 'make install    to PREFIX=$(PREFIX), below DESTDIR if given; uninstall takes it away'
	@echo 'make docs man   reference of the headers (Doxygen) in $(BUILD)/docs/html/, manual pages in $(BUILD)/docs/'
	@echo 'make format     lay out the sources; check-format: only look; check: format, folder order, wording'
	@echo 'make asan       the tests under address and undefined behaviour sanitizers; fuzz: fuzz the readers of files'
	@echo 'make clean      take away $(BUILD)/, build-*/ and out/'

deps:
	@scripts/deps.sh

$(BUILD)/build.ninja:
	meson setup $(BUILD) $(MESON_OPTIONS)

build: deps
	@test -f $(BUILD)/build.ninja || meson setup $(BUILD) $(MESON_OPTIONS)
	@ninja -C $(BUILD)

demo: build
	@mkdir -p out
	$(BUILD)/tools/optla demo $(if $(wildcard ../shared/data/diligent-ball),--data ../shared/data) -o out/demo
	@echo 'Open file://$(CURDIR)/out/demo/index.html'

test: build
	@scripts/run_tests.sh $(BUILD) quick

test-all: build
	@scripts/run_tests.sh $(BUILD) all

bench: build
	@scripts/bench.sh $(BUILD)

install: build
	@meson configure $(BUILD) -Dprefix=$(PREFIX)
	@ninja -C $(BUILD)
	DESTDIR='$(DESTDIR)' meson install -C $(BUILD) --no-rebuild
	@if test -z '$(DESTDIR)' && test "$$(id -u)" = 0; then ldconfig; fi

uninstall:
	@ninja -C $(BUILD) uninstall

docs:
	@command -v doxygen >/dev/null || scripts/deps.sh ci
	@mkdir -p $(BUILD)/docs
	@OUT=$(BUILD)/docs VERSION=$$(sed -n "s/^project.* version: '\([^']*\)'.*/\1/p" meson.build) doxygen docs/Doxyfile
	@echo 'The reference is file://$(CURDIR)/$(BUILD)/docs/html/index.html'

man: build
	@ls $(BUILD)/docs/*.1

format:
	@scripts/format.sh

check-format:
	@scripts/format.sh check

check: check-format
	@scripts/check_layers.sh
	@scripts/check_text.sh

asan: deps
	@scripts/asan.sh

fuzz:
	@scripts/fuzz.sh $(SECONDS)

clean:
	rm -rf $(BUILD) build-* out
