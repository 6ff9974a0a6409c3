#!/bin/sh
# What --explain says, and a build without MPI and without HDF5 (compiled here once, without optimisation).
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=${BUILD:-build}/granhom
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cases=$(pwd)/tests/data/cases
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

head="packing: $cases/packings/p50.data
mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
start: {confinement: 0.05}
steps: [{name: press, increments: 2, displace: [{edge: top, y: -0.1}]}]"

# ---- a build without MPI and HDF5 ----

if [ -n "${SANITIZED:-}" ]; then
  echo "skip - the build without MPI and HDF5 (not under a sanitizer)"
  [ "$failed" = 0 ]
  exit
fi
make --no-print-directory MPI=0 HDF5=0 OPT=-O0 ARCH= BUILD="$work/lean" all >"$work/make" 2>&1
say $? 'make MPI=0 HDF5=0'
lean=$work/lean/granhom
find "$work/lean/src" "$work/lean/driver" -name '*.c.o' -exec nm -u {} + | grep -qE ' (MPI_|ompi_|H5)' && code=1 || code=0
say $code 'its C code names nothing of MPI or HDF5'
ldd "$lean" | grep -q hdf5 && code=1 || code=0
say $code 'it is not linked to HDF5'
"$lean" --version >"$work/said" 2>&1
grep -q 'MPI no' "$work/said" && grep -q 'HDF5 no' "$work/said"; say $? '--version says so'

printf '%s\ncontact: {normal_stiffness: 50}\nmicro: {boundary: taylor-cell}\n' "$head" >"$work/s.yaml"
"$granhom" run "$work/s.yaml" -o "$work/full" >/dev/null 2>&1
say $? 'a scene runs in the full build'
"$lean" run "$work/s.yaml" -o "$work/out" >/dev/null 2>"$work/err"
say $? 'the same scene runs without MPI and HDF5'
grep -q 'built without HDF5' "$work/err"; say $? 'and says what is not written'
[ "$(cd "$work/out" && echo *)" = 'convergence.csv history.csv run.json timing.csv' ]; say $? 'what is written is text'
/usr/bin/python3 - "$work/full/history.csv" "$work/out/history.csv" <<'E'
import csv, sys
a, b = [list(csv.reader(open(f))) for f in sys.argv[1:]]
assert a[0] == b[0] and len(a) == len(b) == 4
for column in ("bottom_y", "top_y", "dilatancy"):
    k = a[0].index(column)
    for p, q in zip(a[1:], b[1:]):
        assert abs(float(p[k]) - float(q[k])) <= 1e-7 * max(abs(float(r[k])) for r in a[1:]), (column, p[k], q[k])
E
say $? 'with the same numbers'

refused() { # words of the message, then the command
  words=$1
  shift
  "$@" >/dev/null 2>"$work/err"
  [ $? = 2 ] && grep -q -e "$words" "$work/err"
}
refused 'restart needs a checkpoint.*without HDF5' "$lean" run "$work/s.yaml" -o "$work/out" --restart
say $? '--restart is refused with the reason'
refused 'results.h5.*without HDF5' "$lean" report "$work/out" -o "$work/r.html"
say $? 'so is a report'
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n' >"$work/path.csv"
refused 'save-state.*without' "$lean" rve "$cases/packings/p50.data" --normal-stiffness 50 --path "$work/path.csv" \
  --boundary taylor -o "$work/o.csv" --save-state "$work/state"
say $? 'so is the state of an RVE'
[ ! -e "$work/o.csv" ]; say $? 'before anything is computed'
"$lean" plot "$work/out" >"$work/said" 2>"$work/err"
say $? 'pictures of what is text are drawn'
grep -q curves.png "$work/said" && grep -q 'no mesh.png.*without HDF5' "$work/err"; say $? 'and the others named'
OMPI_COMM_WORLD_SIZE=2
export OMPI_COMM_WORLD_SIZE
refused 'without MPI.*on 2 ranks' "$lean" run "$work/s.yaml" -o "$work/two"
say $? 'started on two ranks, it refuses'
[ ! -e "$work/two" ]; say $? 'and writes nothing'
[ "$failed" = 0 ]
