# granhom. SPDX-License-Identifier: GPL-2.0-or-later
#   make          builds build/granhom
#   make demo     installs what is missing, builds, runs a block of sand and draws it
#   make check    installs what is missing, builds, runs all tests
#   make bench    times of one RVE update;   make asan / make valgrind   the tests under the checkers
#   make format   clang-format over all sources;   make install   PREFIX=/usr/local
BUILD  ?= build
PREFIX ?= /usr/local
ARCH   ?= -march=native
OPT    ?= -O3
MODULES ?= base io contact packing engine engine/native engine/lammps micro farm macro scene

PKGS   := ompi-c hdf5-openmpi yaml-0.1 libcjson cairo
CC     ?= gcc
CXX    ?= g++
WARN   := -Wall -Wextra -Wpedantic -Werror
FLAGS  := $(OPT) -g $(ARCH) -fno-math-errno $(SAN) $(WARN) -Iinclude -Isrc -I$(BUILD) -DGH_BUILD_FLAGS='"$(OPT) $(ARCH) $(SAN)"'
CPPFLAGS_PKG = $(shell pkg-config --cflags $(PKGS) | sed 's/-I/-isystem /g') -isystem /usr/include/suitesparse
CFLAGS  = -std=c17 -D_XOPEN_SOURCE=700 $(FLAGS) $(CPPFLAGS_PKG) -fexceptions
# LAMMPS's headers are C++11 of their own kind: ours on top of them keep the warnings.
CXXFLAGS = -std=c++17 $(FLAGS) $(CPPFLAGS_PKG) -isystem src/engine/lammps/compat -isystem /usr/include/lammps -DLAMMPS_SMALLBIG -DLAMMPS_LIB_MPI
LDFLAGS = -rdynamic $(SAN)
LDLIBS  = -llammps -lcholmod -lumfpack -lklu $(shell pkg-config --libs $(PKGS)) -lstdc++ -lm

SRC  := $(foreach m,$(MODULES),$(wildcard src/$(m)/*.c src/$(m)/*.cpp))
OBJ  := $(SRC:%=$(BUILD)/%.o)
LIB  := $(BUILD)/libgranhom.a
DRV  := $(wildcard driver/*.c)
DOBJ := $(DRV:%=$(BUILD)/%.o)
TESTS := $(wildcard tests/unit/test_*.c tests/verify/test_*.c tests/extreme/test_*.c)
TBIN := $(TESTS:%.c=$(BUILD)/%)
BENCH := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/bench/*.c))

.PHONY: all lib demo check bench asan valgrind format tidy install clean packages tests-only
.DEFAULT_GOAL := all
.PRECIOUS: $(BUILD)/%.c.o $(BUILD)/%.cpp.o
all: $(BUILD)/granhom
lib: $(LIB)

$(BUILD)/%.c.o: %.c
	@mkdir -p $(@D)
	@echo "  CC   $<"
	@$(CC) $(CFLAGS) -MMD -MP -c $< -o $@
$(BUILD)/%.cpp.o: %.cpp
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) $(CXXFLAGS) -MMD -MP -c $< -o $@
$(LIB): $(OBJ)
	@rm -f $@
	@ar rcs $@ $^
$(BUILD)/granhom: $(DOBJ) $(LIB)
	@echo "  LD   $@"
	@$(CC) $(LDFLAGS) $(DOBJ) $(LIB) $(LDLIBS) -o $@
$(BUILD)/tests/bench/%: $(BUILD)/tests/bench/%.c.o $(LIB)
	@$(CC) $(LDFLAGS) $< $(LIB) $(LDLIBS) -o $@
$(BUILD)/tests/%: $(BUILD)/tests/%.c.o $(LIB)
	@echo "  LD   $@"
	@$(CC) $(LDFLAGS) $< $(LIB) $(LDLIBS) -lcmocka -o $@

packages:
	@scripts/install-packages.sh
demo: packages
	@$(MAKE) --no-print-directory -j$$(nproc) all
	@scripts/demo.sh $(BUILD)
check:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory -j$$(nproc) all tests-only
	@BUILD=$(BUILD) tests/run.sh
tests-only: $(TBIN)
bench: packages
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BENCH)
	@tests/bench/run.sh $(BUILD)
asan:
	@$(MAKE) --no-print-directory -j$$(nproc) BUILD=$(BUILD)-asan SAN="-fsanitize=address,undefined -fno-sanitize-recover=undefined" OPT=-O1 all tests-only
	@BUILD=$(BUILD)-asan SANITIZED=1 tests/run.sh
valgrind:
	@$(MAKE) --no-print-directory -j$$(nproc) BUILD=$(BUILD)-valgrind ARCH=-march=x86-64-v2 OPT=-O1 all tests-only
	@BUILD=$(BUILD)-valgrind tests/valgrind.sh
format:
	@clang-format -i $$(git ls-files '*.c' '*.h' '*.cpp')
# The tables and pictures of docs/verification.md: a quarter of an hour on two cores.
.PHONY: verification
verification:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BUILD)/tests/verify/test_rve_cases
	@scripts/block-study.sh $(BUILD)
install: all
	install -D $(BUILD)/granhom $(DESTDIR)$(PREFIX)/bin/granhom
clean:
	rm -rf $(BUILD) $(BUILD)-asan $(BUILD)-valgrind

-include $(OBJ:.o=.d) $(DOBJ:.o=.d) $(TBIN:%=%.c.d)
