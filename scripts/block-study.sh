#!/bin/sh
# The block of sand under three side pressures and three boundary conditions: runs what has no finished results yet, then puts tables
# into docs/reports/verification.md and curves into docs/figures. block-study.sh BUILD [OUTDIR]; FRESH=1 repeats all runs. Called by
# `make verification`. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
root=$(pwd)
build=${1:-build}
mkdir -p "${2:-$build/block-study}"
out=$(cd "${2:-$build/block-study}" && pwd)
scenes=scenes/block
packings=$root/tests/data/cases/packings
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

# the program may be rebuilt while this is running
cp "$build/granhom" "$out/granhom"
cp "$build/tests/verify/test_rve_cases" "$out/test_rve_cases"

# The block with another packing: other NAME PACKING START PRESSURE, the confinement from START to PRESSURE.
other() {
  sed -e "s|^title:.*|title: Block with the packing $2, periodic, side pressure $4 N/mm|" \
    -e "s|^packing:.*|packing: $packings/$2.data|" -e "s|confinement: 0.01|confinement: $3|" \
    -e "s|from: 0.01, to: 0.2|from: $3, to: $4|" "$scenes/p02_periodic.yaml" >"$out/$1.yaml"
}
for file in "$scenes"/p0[123]_*.yaml; do
  sed "s|^packing: *|packing: $root/$scenes/|" "$file" >"$out/$(basename "$file")"
done
other p150_p02 p150 0.22 0.2
other p150d_p02 p150d 1 0.2
other p150d_p10 p150d 1 1

# A run that fails is a result, too: the report states where and why.
cat >"$out/one.sh" <<'E2'
cd "$1" || exit 1
if [ "${FRESH:-0}" != 1 ] && grep -q '"status":[[:space:]]*"done"' "$2/run.json" 2>/dev/null; then
  echo "$2: has results"
  exit 0
fi
echo "$2 ..."
code=0
timeout "${LIMIT:-3600}" ./granhom run "$2.yaml" -o "$2" --engine lammps >"$2.log" 2>&1 || code=$?
echo "$2: $(tail -n 1 "$2.log") (exit status $code)"
E2
# the slow ones first, so that the two processes end together
for boundary in periodic restricted taylor; do
  for pressure in p03 p02 p01; do echo "${pressure}_$boundary"; done
  [ $boundary = periodic ] && echo "p150_p02 p150d_p02 p150d_p10"
done | xargs -n 1 | xargs -n 1 -P 2 sh "$out/one.sh" "$out"

"$out/test_rve_cases" >"$out/rve_cases.txt" 2>&1 || echo "test_rve_cases failed: see $out/rve_cases.txt" >&2
python=/usr/bin/python3
"$python" -B scripts/block_study.py "$out" docs/reports/verification.md
gnuplot -e "out='$out'; png='docs/figures/block.png'" scripts/block-curves.gp
gnuplot -e "out='$out'; maps='docs/figures/acoustic.png'; strips='docs/figures/jumps.png'" scripts/block-acoustic.gp
echo "docs/reports/verification.md and docs/figures/{block,acoustic,jumps}.png are up to date"
