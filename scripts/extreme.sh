#!/usr/bin/env bash
# Runs the cases of extremes in their full sizes and writes the table of docs/reports/stability.md between its markers. Leaves the page as it
# is when a case fails. SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/.." || exit 1
export BUILD=${1:-build} OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
page=docs/reports/stability.md
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
export GH_EXTREME_FULL=1 GH_EXTREME_TABLE=$work/rows
failed=0
run() { # NAME COMMAND...
  local name=$1 begin=$SECONDS
  shift
  if "$@" >"$work/log" 2>&1; then echo "$name: done in $((SECONDS - begin)) s"; else
    echo "$name: FAILED"
    grep -vE '^\[ (RUN     |      OK) \]|^ok - ' "$work/log" | tail -n 40
    failed=1
  fi
}
for test in tests/extreme/test_*.c; do run "${test##*/}" "$BUILD/${test%.c}"; done
run tests/system/extreme.sh tests/system/extreme.sh
[ $failed = 0 ] || exit 1

awk -F '|' '
  {
    outcome = $4
    sub(/^converged[,;] (error )?/, "", outcome)
    sub(/\(allowed /, "(", outcome)
    sub(/ refused: no equilibrium.*/, " refused", outcome)
    if ($3 ~ /^message, exit status/) sub(/^refused: .*/, "refused", outcome)
  }
  $1 == "Program" {
    count[substr($4, 13, 1)]++
    next
  }
  !($1 in rows) { # a section may have rows of several programs
    sections[++n] = $1
    rows[$1] = sprintf("\n### %s\n\n| case | check | error (allowed), or outcome |\n| --- | --- | --- |\n", $1)
  }
  { rows[$1] = rows[$1] sprintf("| %s | %s | %s |\n", $2, $3, outcome) }
  END {
    for (k = 1; k <= n; ++k) printf "%s", rows[sections[k]]
    print "\n### Program\n"
    printf "Exit status 0 and finite numbers: %d cases; 1: %d; 2: %d (`tests/system/extreme.sh`).\n", count[0], count[1], count[2]
  }' "$work/rows" >"$work/table"
awk -v table="$work/table" '
  /<!-- table: end -->/ { inside = 0 }
  !inside { print }
  /<!-- table: begin/ { inside = 1; while ((getline line < table) > 0) print line; print "" }' "$page" >"$work/page" || exit 1
mv "$work/page" "$page"
chmod 644 "$page"
echo "$(wc -l <"$work/rows") cases in $page"
