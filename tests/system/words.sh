#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
#
# Words of the field: scripts/words.sh finds no private word in the repository, finds each kind in a file made for it, and leaves
# names in the code, innocent words and contracts alone.
set -u
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  scripts/words.sh >"$work/found" 2>&1
  say $? "code, tests, documents and scenes use the terms of the field"
  cat "$work/found"
else
  echo "skip - no git work tree: which files belong to the repository is not known"
fi

cat >"$work/private.c" <<'END'
#include "knob.h"
/* The packing jumped, and the run goes
 * on at once. */
int knob = 1; // beyond the jump
static const char *text = "out of "
                          "balance", c = '"';
int anew(int held); /* `x`: 3 "loose grains" */
END
scripts/words.sh "$work/private.c" | sed "s|^$work/||; s|: [^:]*\$||" >"$work/found"
[ "${PIPESTATUS[0]}" = 1 ] && diff - "$work/found" <<'END'
private.c:2: "packing jumped"
private.c:2: "goes on"
private.c:4: "beyond the jump"
private.c:5: "out of balance"
private.c:7: "loose grains"
END
say $? "comments and strings are read, also across lines; names in the code are not"

printf '# A slip is kept, and\n# packings are taken as they are.\nRelaxation goes in circles (energy defect 1 %%).\n' >"$work/private.md"
[ "$(scripts/words.sh "$work/private.md" | cut -d '"' -f 2 | tr '\n' ,)" = 'slip is kept,taken as they are,goes in circles,energy defect,' ]
say $? "documents are read"

cat >"$work/innocent.c" <<'END'
/* The beginning of a turn; a circle of calls, jumps in a script, energy_defect, `polished` relaxation; told apart; the lock is held. */
const char *level = "polished, damped or fire";
END
scripts/words.sh "$work/innocent.c" && [ -z "$(scripts/words.sh "$work/innocent.c")" ]
say $? "innocent words, columns and values of options are left alone"

scripts/words.sh "$work/missing.c" >/dev/null 2>&1
[ $? = 2 ]
say $? "a file that cannot be read is a failure, not a clean one"
exit $failed
