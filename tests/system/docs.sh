#!/usr/bin/env bash
# Tables of the documents: no row stands there twice, and no key is explained twice in one table. SPDX-License-Identifier:
# GPL-2.0-or-later
set -u
. tests/shell.sh

# twice FILE...: lines of rows that repeat one of the same table, or its first cell where that is a word of code
twice() {
  awk '
    FNR == 1 || !/^\|/ { split("", seen); split("", key); row = 0 }
    !/^\|/ { next }
    ++row <= 2 { next }
    {
      first = $0
      sub(/^\| */, "", first)
      sub(/ *\|.*/, "", first)
      if (($0 in seen) || (first ~ /^`.*`$/ && first in key)) print FILENAME ":" FNR ": " $0
      seen[$0] = key[first] = 1
    }' "$@"
}

bad_table=$(mktemp)
trap 'rm -f "$bad_table"' EXIT
printf '| a | b |\n| --- | --- |\n| `x` | 1 |\n| y | 2 |\n| `x` | 3 |\n| y | 2 |\n\n| a | b |\n| --- | --- |\n| y | 2 |\n' >"$bad_table"
if [ "$(twice "$bad_table" | wc -l)" = 2 ]; then ok "rows that are there twice are found"; else not_ok "rows that are there twice are found" "$(twice "$bad_table")"; fi
found=$(find README.md docs scenes -name '*.md' -print0 | xargs -0 -n 1 bash -c "$(declare -f twice); twice \"\$1\"" twice)
if [ -z "$found" ]; then ok "no row of a table is there twice"; else not_ok "no row of a table is there twice" "$found"; fi
exit $bad
