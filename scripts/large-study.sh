#!/bin/sh
# The biaxial test (scenes/biaxial) and the slope (scenes/slope): runs what has no finished results yet, then puts tables into
# docs/reports/verification-large.md and pictures into docs/figures. large-study.sh BUILD [OUTDIR]
#   FRESH=1            repeats all runs
#   RUNS="NAME ..."    only these of biaxial_taylor biaxial_restricted biaxial_periodic slope_taylor; slope_periodic_friction
#                      runs only when it is named
#   LIMIT=SECONDS      ends each run after this time (default 14400); what it has reached is reported
#   MPIRUN="mpirun -np 2"  put before each run
# SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
root=$(pwd)
build=${1:-build}
mkdir -p "${2:-$build/large-study}"
out=$(cd "${2:-$build/large-study}" && pwd)
runs=${RUNS:-biaxial_taylor biaxial_restricted slope_taylor biaxial_periodic}
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

# the program may be rebuilt while this is running, and two of these may run at once
cp "$build/granhom" "$out/granhom.$$"
mv "$out/granhom.$$" "$out/granhom"

scene_of() {
  case $1 in
    biaxial_*) echo "scenes/biaxial/${1#biaxial_}.yaml" ;;
    *) echo "scenes/slope/$1.yaml" ;;
  esac
}

# A run that fails or is ended is a result, too.
for name in $runs; do
  if [ "${FRESH:-0}" != 1 ] && grep -q '"status":[[:space:]]*"done"' "$out/$name/run.json" 2>/dev/null; then
    echo "$name: has results"
    continue
  fi
  echo "$name ..."
  code=0
  # shellcheck disable=SC2086
  timeout "${LIMIT:-14400}" ${MPIRUN:-} "$out/granhom" run "$(scene_of "$name")" -o "$out/$name" >"$out/$name.log" 2>&1 || code=$?
  echo "$name: $(tail -n 1 "$out/$name.log") (exit status $code)"
done

figures=$root/docs/figures
for name in biaxial_taylor biaxial_restricted biaxial_periodic slope_taylor slope_periodic_friction; do
  [ -e "$out/$name/results.h5" ] || continue
  "$out/granhom" plot "$out/$name" >"$out/$name.plot.log"
  case $name in biaxial_periodic) ;; *) cp "$out/$name/mesh.png" "$figures/$(echo "$name" | tr _ -).png" ;; esac
done
for name in biaxial_taylor biaxial_restricted; do
  for point in 183 117 90 17; do # as in the scenes
    "$out/granhom" plot "$out/$name" --point $point >"$out/$name.plot.log"
    cp "$out/$name/rve.png" "$out/$name.rve.$point.png"
  done
done
gnuplot -e "out='$out'; png='$figures/biaxial-curves.png'; rves='$figures/biaxial-rves.png'; slope='$figures/slope-curves.png'" \
  scripts/large-curves.gp
/usr/bin/env python3 scripts/large_study.py "$out" docs/reports/verification-large.md
echo "docs/reports/verification-large.md and docs/figures/{biaxial,slope}-*.png are up to date"
