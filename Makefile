# granhom. SPDX-License-Identifier: GPL-2.0-or-later
# What `make help` prints:
#   make          builds build/granhom;   make lib   the libraries
#   make packages installs the Debian packages that are missing, as the next two do
#   make demo     installs what is missing, builds, runs a block of sand and draws it
#   make check    installs what is missing, builds, runs all tests
#   make CC=clang check;   make MPI=0 HDF5=0 check   with clang; without ranks and HDF5 files (docs/how-to/install.md). The same
#                 words again with make, install ...
#   make plugin   build/granhomplugin.so, granhom's styles for LAMMPS's own program (docs/reference/lammps/README.md)
#   make debian13 make check in a Debian 13 system made below build/ (scripts/check-debian13.sh; needs root)
#   make asan     the tests under sanitizers;   make valgrind   under valgrind
#   make tidy     clang-tidy over library and program (.clang-tidy);   make format, make format-check   clang-format, or what it would change
#   make bench    times of one RVE update and of the farm
#   make fuzz     an hour of random inputs for all readers and of mutated scripts, scenes and studies (FUZZ_SECONDS, FUZZ_JOBS,
#                 FUZZ_SEED, FUZZ_ONLY="gmsh scene"), on a build with sanitizers; findings are kept in build-fuzz/findings
#   make bitwise  results of scenes and paths against those of an earlier commit, to the last bit (tests/bitwise.sh)
#   make faults   every allocation and every call on files fails once, on one and two ranks: run, rve, element, pack, report ...; half
#                 an hour on two free cores (SAMPLE=N: N points a row, a minute or two)
#   make extreme  the cases of docs/reports/stability.md, the long ones too, and its table
#   make study    tables and pictures of docs/reports/error-vs-time.md (hours); make study QUICK=1 (minutes)
#   make docs     keys, columns and commands in docs/reference, from the program
#   make verification   tables and pictures of docs/reports/verification.md (a quarter of an hour)
#   make install  PREFIX=/usr/local DESTDIR=   program, library, headers, granhom.pc, manual page;   make uninstall;   make clean
# BUILD=DIR: another folder than build; CC, CXX, OPT, ARCH: compilers and their options; DEBUG=1: -O0, and messages say where they come from.
comma := ,
BUILD  ?= build
PREFIX ?= /usr/local
ARCH   ?= -march=native
# DEBUG=1, or OPT=-O0: messages say where they come from (gh_fail_at).
DEBUG  ?= 0
ifeq ($(DEBUG),1)
OPT    ?= -O0
endif
OPT    ?= -O3
DEBUGGED := $(if $(filter 1,$(DEBUG))$(filter -O0,$(OPT)),-DGH_DEBUG)
MODULES ?= base io mesh contact packing engine engine/relax engine/native micro farm control macro prepare direct results report scene crosscheck

# MPI=0: granhom's own code knows no ranks; LAMMPS keeps the MPI that it was built with. HDF5=0: results as text alone.
MPI    ?= 1
HDF5   ?= 1
# Where a package is missing, pkg-config is not heard: the rule `present` names what to install.
PKG_CONFIG := pkg-config --silence-errors
HDF5_PKG := $(if $(filter 0,$(HDF5)),,$(if $(filter 0,$(MPI)),$(shell $(PKG_CONFIG) --exists hdf5-serial 2>/dev/null && echo hdf5-serial || echo hdf5-openmpi),hdf5-openmpi))
PKGS   := $(if $(filter 0,$(MPI)),,ompi-c) $(HDF5_PKG) yaml-0.1 libcjson cairo
LEFT_OUT := $(if $(filter 0,$(MPI)),src/farm/mpi.c src/farm/serve.c src/study/team_mpi.c driver/ranks_mpi.c,src/farm/alone.c src/study/team_alone.c driver/ranks_alone.c) \
  $(if $(filter 0,$(HDF5)),src/io/h5.c,src/io/h5_none.c)
# C++ by the same compiler, unless it is chosen too.
ifneq ($(filter default undefined,$(origin CC)),)
CC     := gcc
endif
ifneq ($(filter default undefined,$(origin CXX)),)
CXX    := $(if $(findstring clang,$(CC)),$(subst clang,clang++,$(CC)),g++)
endif
WARN   := -Wall -Wextra -Wpedantic -Werror
# All objects serve the shared library too: position-independent code costs nothing here (docs/reports/performance.md).
PIC    := -fPIC -fno-semantic-interposition
FLAGS  := $(OPT) -g $(ARCH) -fno-math-errno -fopenmp-simd $(PIC) $(SAN) $(WARN) -Iinclude -Isrc -I$(BUILD) -DGH_BUILD_FLAGS='"$(OPT) $(ARCH) $(SAN)"' $(DEBUGGED)
CPPFLAGS_PKG := $(shell $(PKG_CONFIG) --cflags $(PKGS) 2>/dev/null | sed 's/-I/-isystem /g') -isystem /usr/include/suitesparse $(if $(filter 0,$(MPI)),-DGH_NO_MPI)
MPI_OF_LAMMPS := $(shell $(PKG_CONFIG) --cflags ompi-c 2>/dev/null | sed 's/-I/-isystem /g')
# LAMMPS's headers: those of the package, or the folder `src` of its sources.
LAMMPS ?= /usr/include/lammps
CFLAGS  = -std=c17 -D_XOPEN_SOURCE=700 $(FLAGS) $(CPPFLAGS_PKG) -fexceptions -fvisibility=hidden
# LAMMPS's headers are C++11 of their own kind: ours on top of them keep the warnings.
CXXFLAGS = -std=c++17 $(FLAGS) $(CPPFLAGS_PKG) $(MPI_OF_LAMMPS) -isystem $(LAMMPS) -isystem src/engine/lammps/compat -DLAMMPS_SMALLBIG -DLAMMPS_LIB_MPI
# Sanitizers look for the functions of libstdc++ when the program starts, which loads it with the LAMMPS engine alone.
LDFLAGS = $(SAN) $(if $(SAN),-Wl$(comma)--no-as-needed -lstdc++ -Wl$(comma)--as-needed)
LIBS_RVE = -lcholmod -lklu -lamd -lm
LDLIBS  = -lumfpack $(LIBS_RVE) $(shell $(PKG_CONFIG) --libs $(PKGS) 2>/dev/null)
LIBS_LAMMPS = -llammps -lumfpack $(shell $(PKG_CONFIG) --libs ompi-c 2>/dev/null) -lstdc++ -lm

SRC  := $(filter-out $(LEFT_OUT),$(foreach m,$(MODULES),$(wildcard src/$(m)/*.c src/$(m)/*.cpp)))
OBJ  := $(SRC:%=$(BUILD)/%.o)
LIB  := $(BUILD)/libgranhom.a
# libgranhom-rve: one RVE and what it needs, no more than SuiteSparse, libc and libm.
RVE_SRC := $(filter-out src/io/h5% src/io/json% src/io/seal% src/io/terms% src/io/yaml%,\
  $(filter $(addprefix src/,base/% io/% contact/% packing/% engine/% micro/% control/%),$(SRC)))
RVE_OBJ := $(RVE_SRC:%=$(BUILD)/%.o)
# The LAMMPS engine is loaded when it is asked for (src/engine/module.h). What it shares with the library, it has for itself.
MODULE_SRC := $(wildcard src/engine/lammps/*.c src/engine/lammps/*.cpp)
MODULE_OBJ := $(MODULE_SRC:%=$(BUILD)/%.o)
MODULE_OWN := $(patsubst %,$(BUILD)/src/%.c.o,base/context base/build engine/relax/relax engine/relax/relax_friction engine/relax/relax_friction_run engine/relax/relax_ramp \
  engine/relax/relax_fire engine/relax/relax_frame)
MODULE  := $(BUILD)/granhom-lammps.so
VERSION := $(shell sed -n 's/^\#define GH_VERSION "\(.*\)"/\1/p' include/granhom/granhom.h)
SONAME  := libgranhom.so.$(firstword $(subst ., ,$(VERSION)))
SHARED  := $(BUILD)/libgranhom.so.$(VERSION)
RVE_SONAME := libgranhom-rve.so.$(firstword $(subst ., ,$(VERSION)))
RVE_SHARED := $(BUILD)/libgranhom-rve.so.$(VERSION)
# Studies are a tool of the program, and no part of the libraries.
DRV  := $(filter-out $(LEFT_OUT),$(wildcard driver/*.c src/study/*.c))
DOBJ := $(DRV:%=$(BUILD)/%.o)
STUDY_OBJ := $(filter $(BUILD)/src/study/%,$(DOBJ))
TESTS := $(filter-out $(if $(filter 0,$(HDF5)),tests/unit/test_io_h5.c),$(wildcard tests/unit/test_*.c tests/verify/test_*.c tests/extreme/test_*.c))
TBIN := $(TESTS:%.c=$(BUILD)/%)
STUDY_TBIN := $(filter $(BUILD)/tests/unit/test_study_%,$(TBIN))
BENCH := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/bench/*.c))

# Fuzz targets: with libFuzzer's loop where clang has it, with that of tests/fuzz/standalone.c otherwise.
LIBFUZZER ?= 0
FUZZ := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c))
FUZZ_LOOP := $(if $(filter 0,$(LIBFUZZER)),$(BUILD)/tests/fuzz/standalone.c.o)
FUZZ_OBJ := $(BUILD)/tests/fuzz/fuzz.c.o $(FUZZ_LOOP) $(filter-out %/main.c.o,$(DOBJ))

.PHONY: bitwise all lib demo check bench asan valgrind plugin install uninstall clean packages tests-only fuzz fuzz-build fuzz-targets
.DEFAULT_GOAL := all
.PRECIOUS: $(BUILD)/%.c.o $(BUILD)/%.cpp.o
all: $(BUILD)/granhom $(MODULE)
lib: $(LIB) $(SHARED) $(RVE_SHARED) $(MODULE)

# Objects of another choice of MPI, HDF5, LAMMPS, compilers and their options are not mixed with these.
LAMMPS_VERSION := $(shell $(PKG_CONFIG) --modversion liblammps 2>/dev/null | grep -xE '[0-9]{8}' || echo 0)
CHOICE := MPI=$(MPI) HDF5=$(HDF5) LAMMPS=$(LAMMPS) $(LAMMPS_VERSION) $(lastword $(CC)) $(lastword $(CXX)) $(OPT) $(ARCH) $(SAN) $(DEBUGGED)
$(shell mkdir -p $(BUILD); echo '$(CHOICE)' | cmp -s - $(BUILD)/choice || echo '$(CHOICE)' >$(BUILD)/choice)

# What answers and their seconds depend on, as a number: records of a study tell by it of which build they are.
ANSWERS := $(sort $(filter-out src/report/%,$(SRC)) $(MODULE_SRC) $(addprefix src/study/,path.c follow.c scene_run.c) \
  $(wildcard include/granhom/*.h src/*/*.h src/*/*/*.h))
$(shell printf '\043define GH_SOURCES "%s"\n' "$$(cat $(ANSWERS) | cksum | cut -d' ' -f1)" >$(BUILD)/sources.new; \
  cmp -s $(BUILD)/sources.new $(BUILD)/sources.h && rm $(BUILD)/sources.new || mv $(BUILD)/sources.new $(BUILD)/sources.h)

# Before the first object of a build: are the packages there? (`make demo` and `make check` install them.)
PRESENT := $(BUILD)/present
$(PRESENT): scripts/install-packages.sh $(BUILD)/choice
	@scripts/install-packages.sh missing
	@touch $@
$(BUILD)/%.c.o: %.c Makefile $(BUILD)/choice | $(PRESENT)
	@mkdir -p $(@D)
	@echo "  CC   $<"
	@$(CC) $(CFLAGS) -MMD -MP -c $< -o $@
$(BUILD)/%.cpp.o: %.cpp Makefile $(BUILD)/choice | $(PRESENT)
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) $(CXXFLAGS) -MMD -MP -c $< -o $@
$(BUILD)/src/engine/module_load.c.o: CFLAGS += -DGH_MODULE_LAMMPS=$(LAMMPS_VERSION)
# Products and sums of blocks in one instruction where there is one.
$(BUILD)/src/micro/block_%.c.o: CFLAGS += -ffp-contract=fast
$(LIB): $(OBJ)
	@rm -f $@
	@ar rcs $@ $^
# Sanitizers come with the program, so that a shared object cannot name all that it needs.
SHARE = $(CC) -shared -Wl,--as-needed $(if $(SAN),$(SAN),-Wl,-z,defs)
# The libraries export what is marked GH_API (include/granhom/base.h).
$(SHARED): $(OBJ)
	@echo "  LD   $@"
	@$(SHARE) -Wl,-soname,$(SONAME) $(OBJ) $(LDLIBS) -o $@
$(RVE_SHARED): $(RVE_OBJ)
	@echo "  LD   $@"
	@$(SHARE) -Wl,-soname,$(RVE_SONAME) $(RVE_OBJ) $(LIBS_RVE) -o $@
# Exported are its table, and LAMMPS's functions that it replaces (src/engine/lammps/interpose*.cpp).
$(MODULE): $(MODULE_OBJ) $(MODULE_OWN) scripts/granhom-lammps.map
	@echo "  LD   $@"
	@$(SHARE) -Wl,-Bsymbolic -Wl,--version-script=scripts/granhom-lammps.map $(MODULE_OBJ) $(MODULE_OWN) $(LIBS_LAMMPS) -o $@.tmp && mv $@.tmp $@
$(BUILD)/granhom: $(DOBJ) $(LIB)
	@echo "  LD   $@"
	@$(CC) $(LDFLAGS) $(DOBJ) $(LIB) $(LDLIBS) -o $@
$(STUDY_TBIN): $(STUDY_OBJ)
$(STUDY_TBIN): OF_PROGRAM := $(STUDY_OBJ)
# Tests have the objects of the LAMMPS engine in themselves, whose symbols must come before those of liblammps.so.
# They are a hundred: by the linker that takes a third of the time where there is one, or without a look at what liblammps.so needs.
LINK_TESTS := $(if $(shell command -v ld.gold),-fuse-ld=gold,-Wl$(comma)--allow-shlib-undefined)
TEST_LIBS = $(LINK_TESTS) $(OF_PROGRAM) $(MODULE_OBJ) $(LIB) $(LDLIBS) $(LIBS_LAMMPS)
$(BUILD)/tests/bench/%: $(BUILD)/tests/bench/%.c.o $(LIB) $(MODULE_OBJ)
	@$(CC) -rdynamic $(LDFLAGS) $< $(TEST_LIBS) -o $@
$(BUILD)/tests/fuzz/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.c.o $(FUZZ_OBJ) $(LIB) $(MODULE_OBJ)
	@echo "  LD   $@"
	@$(CC) -rdynamic $(LDFLAGS) $(if $(FUZZ_LOOP),,-fsanitize=fuzzer) $< $(FUZZ_OBJ) $(TEST_LIBS) -o $@
$(BUILD)/tests/%: $(BUILD)/tests/%.c.o $(LIB) $(MODULE_OBJ)
	@echo "  LD   $@"
	@$(CC) -rdynamic $(LDFLAGS) $< $(TEST_LIBS) -lcmocka -o $@

# What tests put into the place of functions of shared libraries must be seen by these.
$(BUILD)/tests/%.c.o: CFLAGS += -fvisibility=default
# tests/unit/test_lean.c counts what granhom's own objects ask for.
COUNTED := malloc calloc realloc _Znwm _ZN9LAMMPS_NS6Memory7smallocElPKc _ZN9LAMMPS_NS6Memory8sreallocEPvlPKc lammps_open lammps_command \
  gh_engine_begin gh_engine_set gh_engine_relax gh_rve_find_rattlers gh_block_pattern_make gh_solver_factor cholmod_factorize klu_factor umfpack_di_numeric gh_rve_tangent gh_rve_tangent_friction
$(BUILD)/tests/unit/test_lean: LDFLAGS += $(COUNTED:%=-Wl,--wrap=%)
# tests/unit/test_solver.c lets them fail.
$(BUILD)/tests/unit/test_solver: LDFLAGS += -Wl,--wrap=calloc,--wrap=realloc,--wrap=free

# The styles for LAMMPS's own program: what they need of this library, and no more. With the package's headers for the package's
# library, so that it can be preloaded (programs that lmp starts see it too); with other headers for the LAMMPS that loads it.
PLUGIN := $(BUILD)/granhomplugin.so
PLUGIN_SRC := $(filter-out %/bridge.c %/bridge_frame.c %/bridge_contacts.c %/bridge_put.c %/bridge_ramp.c %/guard.cpp %/interpose.cpp %/interpose_programs.cpp %/rebind.cpp %/module.c,$(MODULE_SRC)) \
  $(filter src/engine/relax/%,$(SRC))
$(PLUGIN): $(PLUGIN_SRC:%=$(BUILD)/%.o) scripts/granhomplugin.map
	@echo "  LD   $@"
	@$(CXX) -shared -Wl,--version-script=scripts/granhomplugin.map $(SAN) $(filter %.o,$^) $(if $(filter /usr/include/lammps,$(LAMMPS)),-llammps) -lumfpack -lm -o $@
plugin: $(PLUGIN)

# On all cores, unless make was started with -j: then it has its share of these.
PARALLEL = $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$$(nproc))
export MPI HDF5 CC
packages:
	@scripts/install-packages.sh
demo: packages
	@$(MAKE) --no-print-directory $(PARALLEL) all
	@scripts/demo.sh $(BUILD)
check:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory $(PARALLEL) all lib plugin tests-only
	@BUILD=$(BUILD) tests/run.sh
tests-only: $(TBIN) fuzz-targets
fuzz-targets: $(FUZZ)
bench: packages
	@$(MAKE) --no-print-directory $(PARALLEL) all $(BENCH)
	@tests/bench/run.sh $(BUILD)
asan:
	@$(MAKE) --no-print-directory $(PARALLEL) BUILD=$(BUILD)-asan SAN="-fsanitize=address,undefined -fno-sanitize-recover=undefined" OPT=-O1 all tests-only
	@BUILD=$(BUILD)-asan SANITIZED=1 tests/run.sh
# clang's libFuzzer, or gcc's sanitizers and a loop of our own; warnings are gcc's matter in the other builds.
FUZZ_SECONDS ?= 3600
FUZZ_JOBS ?= 2
FUZZ_SEED ?= 1
FUZZ_ONLY ?=
FUZZ_OPT ?= -O1
HAS_LIBFUZZER = $(shell scripts/has-libfuzzer.sh && echo 1 || echo 0)
fuzz-build:
	@$(MAKE) --no-print-directory $(PARALLEL) BUILD=$(BUILD)-fuzz OPT=$(FUZZ_OPT) DEBUGGED= WARN="-w -g1" LIBFUZZER=$(HAS_LIBFUZZER) \
	  $(if $(filter 1,$(HAS_LIBFUZZER)),CC="$(FUZZ_CACHE) clang" CXX="$(FUZZ_CACHE) clang++" SAN="-fsanitize=address$(comma)undefined$(comma)fuzzer-no-link -fno-sanitize=vptr$(comma)function -fno-sanitize-recover=undefined",\
	  SAN="-fsanitize=address$(comma)undefined -fno-sanitize-recover=undefined") all fuzz-targets
fuzz:
	@scripts/install-packages.sh fuzz
	@$(MAKE) --no-print-directory fuzz-build
	@python3 tests/fuzz/run.py --build $(BUILD)-fuzz --seconds $(FUZZ_SECONDS) --jobs $(FUZZ_JOBS) --seed $(FUZZ_SEED) $(FUZZ_ONLY)
valgrind:
	@$(MAKE) --no-print-directory $(PARALLEL) BUILD=$(BUILD)-valgrind ARCH=-march=x86-64-v2 OPT=-O1 all tests-only
	@BUILD=$(BUILD)-valgrind tests/valgrind.sh
# The tables of docs/reference from the program's own.
.PHONY: docs
docs: all
	@scripts/docs.sh $(BUILD)/granhom
# The tables and pictures of docs/reports/verification.md: a quarter of an hour on two cores.
.PHONY: verification
verification:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory $(PARALLEL) all $(BUILD)/tests/verify/test_rve_cases
	@scripts/block-study.sh $(BUILD)
# Against an earlier commit; an hour.
bitwise: all
	@BUILD=$(BUILD) tests/bitwise.sh
# Calls that fail (docs/explanation/architecture.md, "Failing calls"); a sample of it is in make check.
.PHONY: faults
faults:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory $(PARALLEL) all
	@BUILD=$(BUILD) tests/faults/run.sh
# The table of docs/reports/stability.md: some minutes.
.PHONY: extreme
extreme:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory $(PARALLEL) all $(patsubst %.c,$(BUILD)/%,$(wildcard tests/extreme/test_*.c))
	@scripts/extreme.sh $(BUILD)
# The tables and pictures of docs/reports/error-vs-time.md: hours; QUICK=1: small versions in minutes, in $(BUILD)/studies/quick.
.PHONY: study
study:
	@scripts/install-packages.sh check
	@$(MAKE) --no-print-directory $(PARALLEL) all
	@scripts/study.sh $(BUILD)
bindir := $(PREFIX)/bin
libdir := $(PREFIX)/lib
incdir := $(PREFIX)/include
mandir := $(PREFIX)/share/man/man1
# The manual page is made of what `granhom help` states.
$(BUILD)/granhom.1: $(BUILD)/granhom scripts/man.sh man/granhom.1.in
	@scripts/man.sh $(BUILD)/granhom man/granhom.1.in >$@.tmp && mv $@.tmp $@
install: all lib $(BUILD)/granhom.1
	install -d $(DESTDIR)$(bindir) $(DESTDIR)$(libdir)/granhom $(DESTDIR)$(libdir)/pkgconfig $(DESTDIR)$(incdir)/granhom $(DESTDIR)$(mandir)
	install $(BUILD)/granhom $(DESTDIR)$(bindir)/granhom
	install -m 644 $(LIB) $(SHARED) $(RVE_SHARED) $(DESTDIR)$(libdir)
	install -m 644 $(MODULE) $(DESTDIR)$(libdir)/granhom
	$(CC) $(CFLAGS) -DGH_MODULE_LAMMPS=$(LAMMPS_VERSION) -DGH_MODULE_PLACE='"$(libdir)/granhom"' -c src/engine/module_load.c -o $(DESTDIR)$(libdir)/module_load.c.o
	cd $(DESTDIR)$(libdir) && ar r libgranhom.a module_load.c.o && rm module_load.c.o
	ln -sf $(notdir $(SHARED)) $(DESTDIR)$(libdir)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(libdir)/libgranhom.so
	ln -sf $(notdir $(RVE_SHARED)) $(DESTDIR)$(libdir)/$(RVE_SONAME)
	ln -sf $(RVE_SONAME) $(DESTDIR)$(libdir)/libgranhom-rve.so
	install -m 644 include/granhom/*.h $(DESTDIR)$(incdir)/granhom
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@LIBS@|$(LDLIBS)|' scripts/granhom.pc.in \
	  >$(DESTDIR)$(libdir)/pkgconfig/granhom.pc
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' scripts/granhom-rve.pc.in \
	  >$(DESTDIR)$(libdir)/pkgconfig/granhom-rve.pc
	install -m 644 $(BUILD)/granhom.1 $(DESTDIR)$(mandir)
uninstall:
	rm -f $(DESTDIR)$(bindir)/granhom $(DESTDIR)$(libdir)/libgranhom.a $(DESTDIR)$(libdir)/libgranhom.so $(DESTDIR)$(libdir)/$(SONAME)
	rm -f $(DESTDIR)$(libdir)/$(notdir $(SHARED)) $(DESTDIR)$(libdir)/pkgconfig/granhom.pc $(DESTDIR)$(mandir)/granhom.1
	rm -f $(addprefix $(DESTDIR)$(libdir)/,$(notdir $(RVE_SHARED)) $(RVE_SONAME) libgranhom-rve.so pkgconfig/granhom-rve.pc granhom/$(notdir $(MODULE)))
	rm -f $(patsubst include/%,$(DESTDIR)$(incdir)/%,$(wildcard include/granhom/*.h))
	-rmdir $(DESTDIR)$(incdir)/granhom $(DESTDIR)$(libdir)/granhom
include scripts/checks.mk
clean:
	rm -rf $(BUILD) $(BUILD)-asan $(BUILD)-valgrind $(BUILD)-fuzz

-include $(OBJ:.o=.d) $(MODULE_OBJ:.o=.d) $(DOBJ:.o=.d) $(TBIN:%=%.c.d) $(FUZZ:%=%.c.d)
