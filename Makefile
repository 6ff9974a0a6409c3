# granhom. SPDX-License-Identifier: GPL-2.0-or-later
#   make          builds build/granhom
#   make demo     installs what is missing, builds, runs a block of sand and draws it
#   make check    installs what is missing, builds, runs all tests
#   make bench    times of one RVE update and of the farm;   make asan / make valgrind   the tests under the checkers
#   make fuzz     an hour of random inputs for all readers and of mutated scripts, scenes and studies (FUZZ_SECONDS, FUZZ_JOBS,
#                 FUZZ_SEED, FUZZ_ONLY="gmsh scene"), on a build with sanitizers; findings are kept in build-fuzz/findings
#   make faults   every allocation and every call on files fails once: run, rve, element, pack, report ... (SAMPLE=N: N points a row)
#   make extreme  the cases of docs/reports/stability.md, the long ones too, and its table
#   make study    tables and pictures of docs/reports/error-vs-time.md (hours); make study QUICK=1 (minutes)
#   make docs     keys, columns and commands in docs/reference, from the program
#   make format   clang-format over all sources
#   make MPI=0 HDF5=0   without ranks, without HDF5 files (docs/user-guide.md); the same words again with make check, install ...
#   make install   PREFIX=/usr/local DESTDIR=   program, library, headers, granhom.pc, manual page;   make uninstall
BUILD  ?= build
PREFIX ?= /usr/local
ARCH   ?= -march=native
OPT    ?= -O3
MODULES ?= base io mesh contact packing engine engine/native engine/lammps micro farm control macro prepare results report scene crosscheck study

# MPI=0: granhom's own code knows no ranks; LAMMPS keeps the MPI that it was built with. HDF5=0: results as text alone.
MPI    ?= 1
HDF5   ?= 1
HDF5_PKG := $(if $(filter 0,$(HDF5)),,$(if $(filter 0,$(MPI)),$(shell pkg-config --exists hdf5-serial && echo hdf5-serial || echo hdf5-openmpi),hdf5-openmpi))
PKGS   := $(if $(filter 0,$(MPI)),,ompi-c) $(HDF5_PKG) yaml-0.1 libcjson cairo
LEFT_OUT := $(if $(filter 0,$(MPI)),src/farm/mpi.c src/farm/serve.c src/study/team_mpi.c driver/ranks_mpi.c,src/farm/alone.c src/study/team_alone.c driver/ranks_alone.c) \
  $(if $(filter 0,$(HDF5)),src/io/h5.c,src/io/h5_none.c)
CC     ?= gcc
CXX    ?= g++
WARN   := -Wall -Wextra -Wpedantic -Werror
# All objects serve the shared library too: position-independent code costs nothing here (docs/reports/performance.md).
PIC    := -fPIC -fno-semantic-interposition
FLAGS  := $(OPT) -g $(ARCH) -fno-math-errno $(PIC) $(SAN) $(WARN) -Iinclude -Isrc -I$(BUILD) -DGH_BUILD_FLAGS='"$(OPT) $(ARCH) $(SAN)"'
CPPFLAGS_PKG := $(shell pkg-config --cflags $(PKGS) | sed 's/-I/-isystem /g') -isystem /usr/include/suitesparse $(if $(filter 0,$(MPI)),-DGH_NO_MPI)
MPI_OF_LAMMPS := $(shell pkg-config --cflags ompi-c | sed 's/-I/-isystem /g')
CFLAGS  = -std=c17 -D_XOPEN_SOURCE=700 $(FLAGS) $(CPPFLAGS_PKG) -fexceptions
# LAMMPS's headers are C++11 of their own kind: ours on top of them keep the warnings.
CXXFLAGS = -std=c++17 $(FLAGS) $(CPPFLAGS_PKG) $(MPI_OF_LAMMPS) -isystem /usr/include/lammps -isystem src/engine/lammps/compat -DLAMMPS_SMALLBIG -DLAMMPS_LIB_MPI
LDFLAGS = -rdynamic $(SAN)
LDLIBS  = -llammps -lcholmod -lumfpack -lklu $(shell pkg-config --libs $(PKGS) ompi-c) -lstdc++ -lm

SRC  := $(filter-out $(LEFT_OUT),$(foreach m,$(MODULES),$(wildcard src/$(m)/*.c src/$(m)/*.cpp)))
OBJ  := $(SRC:%=$(BUILD)/%.o)
LIB  := $(BUILD)/libgranhom.a
VERSION := $(shell sed -n 's/^\#define GH_VERSION "\(.*\)"/\1/p' include/granhom/granhom.h)
SONAME  := libgranhom.so.$(firstword $(subst ., ,$(VERSION)))
SHARED  := $(BUILD)/libgranhom.so.$(VERSION)
DRV  := $(filter-out $(LEFT_OUT),$(wildcard driver/*.c))
DOBJ := $(DRV:%=$(BUILD)/%.o)
TESTS := $(wildcard tests/unit/test_*.c tests/verify/test_*.c tests/extreme/test_*.c)
TBIN := $(TESTS:%.c=$(BUILD)/%)
BENCH := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/bench/*.c))

# Fuzz targets: with libFuzzer's loop where clang has it, with that of tests/fuzz/standalone.c otherwise.
LIBFUZZER ?= 0
FUZZ := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c))
FUZZ_LOOP := $(if $(filter 0,$(LIBFUZZER)),$(BUILD)/tests/fuzz/standalone.c.o)
FUZZ_OBJ := $(BUILD)/tests/fuzz/fuzz.c.o $(FUZZ_LOOP) $(filter-out %/main.c.o,$(DOBJ))

.PHONY: all lib demo check bench asan valgrind format tidy install uninstall clean packages tests-only fuzz fuzz-build fuzz-targets
.DEFAULT_GOAL := all
.PRECIOUS: $(BUILD)/%.c.o $(BUILD)/%.cpp.o
all: $(BUILD)/granhom
lib: $(LIB) $(SHARED)

# Objects of another choice of MPI and HDF5 are not mixed with these.
CHOICE := MPI=$(MPI) HDF5=$(HDF5)
$(shell mkdir -p $(BUILD); echo '$(CHOICE)' | cmp -s - $(BUILD)/choice || echo '$(CHOICE)' >$(BUILD)/choice)

# What answers and their seconds depend on, as a number: records of a study tell by it of which build they are.
ANSWERS := $(sort $(filter-out src/study/% src/report/%,$(SRC)) $(addprefix src/study/,path.c follow.c scene_run.c) \
  $(wildcard include/granhom/*.h src/*/*.h src/*/*/*.h))
$(shell printf '\043define GH_SOURCES "%s"\n' "$$(cat $(ANSWERS) | cksum | cut -d' ' -f1)" >$(BUILD)/sources.new; \
  cmp -s $(BUILD)/sources.new $(BUILD)/sources.h && rm $(BUILD)/sources.new || mv $(BUILD)/sources.new $(BUILD)/sources.h)

$(BUILD)/%.c.o: %.c Makefile $(BUILD)/choice
	@mkdir -p $(@D)
	@echo "  CC   $<"
	@$(CC) $(CFLAGS) -MMD -MP -c $< -o $@
$(BUILD)/%.cpp.o: %.cpp Makefile $(BUILD)/choice
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) $(CXXFLAGS) -MMD -MP -c $< -o $@
$(LIB): $(OBJ)
	@rm -f $@
	@ar rcs $@ $^
# What the library exports: gh_*, and LAMMPS's functions that it replaces (src/engine/lammps/guard.cpp).
$(SHARED): $(OBJ) scripts/libgranhom.map
	@echo "  LD   $@"
	@$(CC) -shared -Wl,-soname,$(SONAME) -Wl,--version-script=scripts/libgranhom.map -Wl,-z,defs $(SAN) $(OBJ) $(LDLIBS) -o $@
$(BUILD)/granhom: $(DOBJ) $(LIB)
	@echo "  LD   $@"
	@$(CC) $(LDFLAGS) $(DOBJ) $(LIB) $(LDLIBS) -o $@
$(BUILD)/tests/bench/%: $(BUILD)/tests/bench/%.c.o $(LIB)
	@$(CC) $(LDFLAGS) $< $(LIB) $(LDLIBS) -o $@
$(BUILD)/tests/fuzz/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.c.o $(FUZZ_OBJ) $(LIB)
	@echo "  LD   $@"
	@$(CC) $(LDFLAGS) $(if $(FUZZ_LOOP),,-fsanitize=fuzzer) $^ $(LDLIBS) -o $@
$(BUILD)/tests/%: $(BUILD)/tests/%.c.o $(LIB)
	@echo "  LD   $@"
	@$(CC) $(LDFLAGS) $< $(LIB) $(LDLIBS) -lcmocka -o $@

# tests/unit/test_lean.c counts what granhom's own objects ask for.
COUNTED := malloc calloc realloc _Znwm _ZN9LAMMPS_NS6Memory7smallocElPKc _ZN9LAMMPS_NS6Memory8sreallocEPvlPKc lammps_open lammps_command \
  gh_engine_begin gh_engine_set gh_engine_relax gh_rve_find_rattlers cholmod_analyze cholmod_factorize klu_analyze klu_factor umfpack_di_numeric gh_rve_tangent gh_rve_tangent_friction
$(BUILD)/tests/unit/test_lean: LDFLAGS += $(COUNTED:%=-Wl,--wrap=%)

export MPI HDF5
packages:
	@scripts/install-packages.sh
demo: packages
	@$(MAKE) --no-print-directory -j$$(nproc) all
	@scripts/demo.sh $(BUILD)
check:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory -j$$(nproc) all lib tests-only
	@BUILD=$(BUILD) tests/run.sh
tests-only: $(TBIN) fuzz-targets
fuzz-targets: $(FUZZ)
bench: packages
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BENCH)
	@tests/bench/run.sh $(BUILD)
asan:
	@$(MAKE) --no-print-directory -j$$(nproc) BUILD=$(BUILD)-asan SAN="-fsanitize=address,undefined -fno-sanitize-recover=undefined" OPT=-O1 all tests-only
	@BUILD=$(BUILD)-asan SANITIZED=1 tests/run.sh
# clang's libFuzzer, or gcc's sanitizers and a loop of our own; warnings are gcc's matter in the other builds.
FUZZ_SECONDS ?= 3600
FUZZ_JOBS ?= 2
FUZZ_SEED ?= 1
FUZZ_ONLY ?=
HAS_LIBFUZZER = $(shell scripts/has-libfuzzer.sh && echo 1 || echo 0)
fuzz-build:
	@$(MAKE) --no-print-directory -j$$(nproc) BUILD=$(BUILD)-fuzz OPT=-O1 WARN=-w LIBFUZZER=$(HAS_LIBFUZZER) \
	  $(if $(filter 1,$(HAS_LIBFUZZER)),CC="$(FUZZ_CACHE) clang" CXX="$(FUZZ_CACHE) clang++" SAN="-fsanitize=address$(comma)undefined$(comma)fuzzer-no-link -fno-sanitize=vptr$(comma)function -fno-sanitize-recover=undefined",\
	  SAN="-fsanitize=address$(comma)undefined -fno-sanitize-recover=undefined") all fuzz-targets
comma := ,
fuzz:
	@scripts/install-packages.sh fuzz
	@$(MAKE) --no-print-directory fuzz-build
	@python3 tests/fuzz/run.py --build $(BUILD)-fuzz --seconds $(FUZZ_SECONDS) --jobs $(FUZZ_JOBS) --seed $(FUZZ_SEED) $(FUZZ_ONLY)
valgrind:
	@$(MAKE) --no-print-directory -j$$(nproc) BUILD=$(BUILD)-valgrind ARCH=-march=x86-64-v2 OPT=-O1 all tests-only
	@BUILD=$(BUILD)-valgrind tests/valgrind.sh
format:
	@clang-format -i $$(git ls-files '*.c' '*.h' '*.cpp')
# The tables of docs/reference from the program's own.
.PHONY: docs
docs: all
	@scripts/docs.sh $(BUILD)/granhom
# The tables and pictures of docs/reports/verification.md: a quarter of an hour on two cores.
.PHONY: verification
verification:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BUILD)/tests/verify/test_rve_cases
	@scripts/block-study.sh $(BUILD)
# Calls that fail (docs/explanation/architecture.md, "Failing calls"); a sample of it is in make check.
.PHONY: faults
faults:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory -j$$(nproc) all
	@BUILD=$(BUILD) tests/faults/run.sh
# The table of docs/reports/stability.md: some minutes.
.PHONY: extreme
extreme:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory -j$$(nproc) all $(patsubst %.c,$(BUILD)/%,$(wildcard tests/extreme/test_*.c))
	@scripts/extreme.sh $(BUILD)
# The tables and pictures of docs/reports/error-vs-time.md: hours; QUICK=1: small versions in minutes, in $(BUILD)/studies/quick.
.PHONY: study
study:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory -j$$(nproc) all
	@scripts/study.sh $(BUILD)
bindir := $(PREFIX)/bin
libdir := $(PREFIX)/lib
incdir := $(PREFIX)/include
mandir := $(PREFIX)/share/man/man1
# The manual page is made of what `granhom help` says.
$(BUILD)/granhom.1: $(BUILD)/granhom scripts/man.sh man/granhom.1.in
	@scripts/man.sh $(BUILD)/granhom man/granhom.1.in >$@.tmp && mv $@.tmp $@
install: all lib $(BUILD)/granhom.1
	install -d $(DESTDIR)$(bindir) $(DESTDIR)$(libdir)/pkgconfig $(DESTDIR)$(incdir)/granhom $(DESTDIR)$(mandir)
	install $(BUILD)/granhom $(DESTDIR)$(bindir)/granhom
	install -m 644 $(LIB) $(SHARED) $(DESTDIR)$(libdir)
	ln -sf $(notdir $(SHARED)) $(DESTDIR)$(libdir)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(libdir)/libgranhom.so
	install -m 644 include/granhom/*.h $(DESTDIR)$(incdir)/granhom
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@LIBS@|-rdynamic $(SAN) $(LDLIBS)|' scripts/granhom.pc.in \
	  >$(DESTDIR)$(libdir)/pkgconfig/granhom.pc
	install -m 644 $(BUILD)/granhom.1 $(DESTDIR)$(mandir)
uninstall:
	rm -f $(DESTDIR)$(bindir)/granhom $(DESTDIR)$(libdir)/libgranhom.a $(DESTDIR)$(libdir)/libgranhom.so $(DESTDIR)$(libdir)/$(SONAME)
	rm -f $(DESTDIR)$(libdir)/$(notdir $(SHARED)) $(DESTDIR)$(libdir)/pkgconfig/granhom.pc $(DESTDIR)$(mandir)/granhom.1
	rm -f $(patsubst include/%,$(DESTDIR)$(incdir)/%,$(wildcard include/granhom/*.h))
	-rmdir $(DESTDIR)$(incdir)/granhom
clean:
	rm -rf $(BUILD) $(BUILD)-asan $(BUILD)-valgrind $(BUILD)-fuzz

-include $(OBJ:.o=.d) $(DOBJ:.o=.d) $(TBIN:%=%.c.d) $(FUZZ:%=%.c.d)
