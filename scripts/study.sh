#!/bin/sh
# Error against run time: grows the ensembles of packings, runs the studies of scenes/studies (granhom study), then puts their tables and
# pictures into docs/reports/error-vs-time.md and docs/figures. Finished runs are not repeated.
#   study.sh BUILD [OUTDIR]   results are kept in OUTDIR (default BUILD/studies)
#   QUICK=1                   small versions of all studies, in OUTDIR/quick; the page is written there and docs/ is left alone
#   STUDIES="NAME ..."        only these
#   RANKS=N                   default: one for each core
# Seconds count on a machine that does nothing else. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
build=${1:-build}
quick=${QUICK:-0}
out=${2:-$build/studies}
[ "$quick" = 1 ] && out=$out/quick
mkdir -p "$out"
out=$(cd "$out" && pwd)
packings=scenes/studies/packings
studies=${STUDIES:-$(cd scenes/studies && ls ./*.yaml | sed 's|^\./||; s|\.yaml$||')}
ranks=${RANKS:-$(env -u OMP_NUM_THREADS nproc)} # nproc takes OMP_NUM_THREADS for the number of cores
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 OMPI_MCA_rmaps_base_oversubscribe=1
[ "$(id -u)" != 0 ] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
spread=
[ "$ranks" -le 1 ] || ! command -v mpirun >/dev/null || spread="mpirun -np $ranks --bind-to none"

# the program may be rebuilt while this is running
cp "$build/granhom" "$out/granhom.$$"
mv "$out/granhom.$$" "$out/granhom"

sizes="2400 1200 600 300 150 88" # longest first: as many ensembles as ranks grow side by side
[ "$quick" = 1 ] && sizes="300 150 88"
mkdir -p "$packings"
wanted=
for n in $sizes; do
  [ ! -e "$packings/p$n-015.data" ] || continue
  echo "fifteen packings of $n grains ..."
  grains="scenes/packings/block150.yaml --count $n"
  # the largest fraction needs 150 grains
  [ "$n" -ge 150 ] || grains="--sieve scenes/packings/biaxial.csv --finish overlap=0.001 --finish-cell relaxed"
  wanted="$wanted$grains --seed 1 --ensemble 15 -o $packings/p$n.data
"
done
# the slope: five packings; twice and three times as many elements each way
[ -e "$packings/s700-005.data" ] || wanted="${wanted}scenes/packings/slope700.yaml --ensemble 5 -o $packings/s700.data
"
if ! printf %s "$wanted" | xargs -r -L 1 -P "$ranks" "$out/granhom" pack >"$packings/grow.log" 2>&1; then
  tail -n 5 "$packings/grow.log" >&2
  exit 1
fi
mkdir -p scenes/studies/meshes
for finer in 2 3; do
  /usr/bin/env python3 scenes/slope/make_mesh.py $finer >scenes/studies/meshes/slope-$finer.msh
done

for name in $studies; do
  option=
  [ "$quick" = 1 ] && option=--quick
  echo "$name ..."
  code=0
  # shellcheck disable=SC2086
  $spread "$out/granhom" study "scenes/studies/$name.yaml" -o "$out/$name" $option >"$out/$name.log" 2>&1 || code=$?
  [ $code = 0 ] || { tail -n 5 "$out/$name.log" >&2; exit $code; }
done

if [ "$quick" = 1 ]; then
  mkdir -p "$out/figures" "$out/reports"
  cp docs/reports/error-vs-time.md "$out/reports/error-vs-time.md"
  /usr/bin/env python3 scripts/study_page.py "$out" "$out/reports/error-vs-time.md"
else
  /usr/bin/env python3 scripts/study_page.py "$out" docs/reports/error-vs-time.md
fi
