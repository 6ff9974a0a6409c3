# Rules that look at the sources or run the checks elsewhere; included by the Makefile. SPDX-License-Identifier: GPL-2.0-or-later
.PHONY: help format format-check tidy debian13
help:
	@sed -n '1,/^BUILD/s/^#   //p; s/^# \(BUILD=\)/\1/p' Makefile

SOURCES = $$(git ls-files '*.c' '*.h' '*.cpp')
format:
	@clang-format -i $(SOURCES)
format-check:
	@scripts/install-packages.sh format
	@clang-format --dry-run --Werror $(SOURCES)
	@echo "format-check: no differences"

# The library, the LAMMPS engine and the program, one file at a time: again when it, one of its headers or .clang-tidy has changed.
TIDY := $(addsuffix .tidy,$(addprefix $(BUILD)/,$(SRC) $(MODULE_SRC) $(DRV)))
tidy:
	@scripts/install-packages.sh tidy
	@$(MAKE) --no-print-directory -k $(PARALLEL) $(TIDY)
	@echo "tidy: $(words $(TIDY)) files, no findings"
# clang does not know some options of gcc, and its plain warnings are those of `make CC=clang`.
TIDY_FLAGS = -Wno-unknown-warning-option -Wno-ignored-optimization-argument -w
$(BUILD)/%.c.tidy: %.c .clang-tidy $(BUILD)/%.c.o
	@echo "  TIDY $<"
	@clang-tidy --quiet --warnings-as-errors='*' $< -- $(CFLAGS) $(TIDY_FLAGS) 2>$@.err || { cat $@.err >&2; exit 1; }
	@touch $@
$(BUILD)/%.cpp.tidy: %.cpp .clang-tidy $(BUILD)/%.cpp.o
	@echo "  TIDY $<"
	@clang-tidy --quiet --warnings-as-errors='*' $< -- $(CXXFLAGS) $(TIDY_FLAGS) 2>$@.err || { cat $@.err >&2; exit 1; }
	@touch $@

debian13:
	@scripts/check-debian13.sh
