#!/bin/sh
# What --explain states, and a build without MPI and without HDF5 (compiled here once, without optimisation).
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=${BUILD:-build}/granhom
"$granhom" --version | grep -q '^HDF5 yes' || { echo "skip - what a scene pays for, and the build without MPI and HDF5 (no HDF5)"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cases=$(pwd)/tests/data/cases
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

head="packing: $cases/packings/p50.data
mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
start: {confinement: 0.05}
steps: [{name: press, increments: 2, displace: [{edge: top, y: -0.1}]}]"

# ---- --explain ----

# explain NAME 'lines of the scene' 'words that must be said' ... ; '! words' must not be said
explain() {
  name=$1
  printf '%s\n%s\n' "$head" "$2" >"$work/e.yaml"
  shift 2
  "$granhom" run "$work/e.yaml" --explain $options >"$work/said" 2>"$work/err"
  code=$?
  for words; do
    case $words in
    '! '*) ! grep -q -e "${words#! }" "$work/said" || { code=1; echo "# said: ${words#! }"; } ;;
    *) grep -q -e "$words" "$work/said" || { code=1; echo "# not said: $words"; } ;;
    esac
  done
  say $code "--explain: $name"
}
smooth='contact: {normal_stiffness: 50}'
rough='contact: {normal_stiffness: 50, friction_angle: 20}'
options=
explain 'frictionless, periodic' "$smooth" 'periodic: the cell follows F, all its grains are relaxed' '; frictionless' \
  'relaxation        central differences, then Newton' 'left out *grain rotations, tangential forces and the history of contacts (frictionless)$' \
  'symmetric (no friction, dead loads): CHOLMOD' 'consistent tangent' 'ranks             one: nothing is sent' '! factorisation of the grains' \
  'grains and contacts of all points' '! dumps' '! footing' '! automatic' 'step 1            press: 2 increments'
explain 'damped' "$smooth
micro: {relaxation: damped}" 'relaxation        damped: central differences alone, without Newton, to a residual of 1e-08'
explain 'FIRE' "$smooth
micro: {relaxation: fire, tolerance: 1e-6}" 'relaxation        fire: FIRE alone, without Newton, to a residual of 1e-06'
explain 'friction' "$rough" 'Coulomb friction 0.36397 (20 degrees)' 'unsymmetric (friction): UMFPACK' \
  'left out *hardening of contacts that have opened$' '! history of contacts'
explain 'friction without rotations, Taylor' "contact: {normal_stiffness: 50, friction_angle: 20, rotations: fixed}
micro: {boundary: taylor}" 'left out *grain rotations; relaxation, factorisation of the grains. stiffness; hardening' '! central differences' \
  'lammps, for the contacts only'
explain 'friction, periodic' "$rough" 'slip              integrated along ramps of F'
explain 'friction without rotations, periodic' "contact: {normal_stiffness: 50, friction_angle: 20, rotations: fixed}
micro: {integration: whole}" 'slip              integrated over whole increments' 'left out *grain rotations; hardening'
explain 'proportional hardening' "contact: {normal_stiffness: 50, friction_angle: 20, hardening: 3, hardening_law: proportional}" \
  'hardening 3 times the normal force' 'left out *nothing'
explain 'friction, Taylor' "$rough
micro: {boundary: taylor-cell, engine: native}" 'native, for contacts and rotations' 'left out *motion of the grains but their rotations' 'central differences'
explain 'Taylor' "$smooth
micro: {boundary: taylor}" 'no relaxation, the tangent is a sum over contacts' "relaxation, factorisation of the grains' stiffness" '! central differences'
explain 'records and dumps' "$smooth
results: {rves: [0, 3], dump: [1]}" 'grains and contacts of 2 points;' 'LAMMPS dumps of 1 point$'
explain 'frozen tangent, automatic increments' "$smooth
solver: {tangent: frozen, increments: automatic, at_once: 8}" 'tangent of the last equilibrium, factorised once' 'at most 200 iterations' \
  'left out .*tangents of the packings but at the end of an increment' 'automatic: up to 8 planned ones at once'
explain 'elastic tangent' "$smooth
solver: {tangent: elastic, max_iterations: 50}" 'tangent of the packings as read' 'at most 50 iterations'
explain 'symmetrised tangent' "$rough
solver: {tangent: symmetrised}" 'made symmetric: CHOLMOD' '! unsymmetric'
head_before=$head
head=$(printf '%s' "$head" | sed 's/^steps:.*/steps: [{name: press, increments: 2, pressure: [{edge: right, to: 0.1, follow: true}, {edge: left, to: 0.1, follow: true}], footing: [{edge: top, force: [0, -0.1]}]}]/; s/^supports:.*/supports: [{edge: bottom, fix: both}]/')
explain 'a footing, pressure that follows' "$rough" 'unsymmetric (friction, pressure that follows the edge): UMFPACK' 'three unknowns for each footing' "rigid footing on 'top'"
head=$(printf '%s' "$head_before" | sed "s|^packing:.*|packing: [$cases/packings/p50.data, $cases/packings/p20.data]|")
options=--no-share
explain 'several packings, not shared' "$smooth" '16, of 2 packings in turn' '8 of 50 grains' '8 of 20 grains' 'each of the 16 points is computed'
options=
head=$head_before
printf '%s\n%s\n' "$head" "$smooth" >"$work/e.yaml"
mpirun --oversubscribe -n 2 "$granhom" run "$work/e.yaml" --explain >"$work/said" 2>&1
grep -q 'ranks *2: rank 0 assembles and solves, all of them compute RVEs, which move' "$work/said"; say $? '--explain: two ranks'

# ---- keys of the solver ----

wrong() { # lines, words
  printf '%s\n%s\n%s\n' "$head" "$smooth" "$1" >"$work/e.yaml"
  "$granhom" run "$work/e.yaml" -o "$work/none" >/dev/null 2>"$work/err"
  [ $? = 2 ] && grep -q "e.yaml:7: $2" "$work/err" && [ ! -e "$work/none" ]
  say $? "refused: $1"
}
wrong 'solver: {tangent: secant}' "tangent 'secant' is none of algorithmic, symmetrised, frozen, elastic"
wrong 'micro: {relaxation: newton}' "relaxation 'newton' is none of polished, damped, fire"
wrong 'micro: {accept: -1}' 'accept'
wrong 'solver: {search_memory: 0}' 'search_memory'
wrong 'solver: {search_memory: 11}' 'search_memory'
wrong 'solver: {increments: few}' "increments 'few' is none of planned, automatic"
wrong 'solver: {at_once: 4}' 'at_once needs `increments: automatic`'
wrong 'solver: {increments: automatic, at_once: 0}' 'at_once'

# ---- automatic increments: the end of each step is that of the plan; Taylor without friction knows no path ----

long=$(printf '%s' "$head" | sed 's/^steps:.*/steps: [{name: press, increments: 23, displace: [{edge: top, y: -0.1}]}, {name: shear, increments: 9, displace: [{edge: top, x: 0.05, y: -0.1}]}]/')
for kind in planned automatic; do
  printf '%s\n%s\nmicro: {boundary: taylor-cell}\nsolver: {tolerance: 1.0e-11, increments: %s}\n' "$long" "$smooth" $kind >"$work/$kind.yaml"
  "$granhom" run "$work/$kind.yaml" -o "$work/$kind" >/dev/null 2>"$work/err"
  say $? "increments $kind"
done
cat >"$work/compare.py" <<'E'
import csv, sys
plan, auto = [[r for r in csv.DictReader(open(f))] for f in sys.argv[1:]]
assert len(plan) == 1 + 23 + 9 and len(auto) <= 16, (len(plan), len(auto))
at = {(r["name"], r["increment"]): r for r in plan}
taken = [int(b["increment"]) - int(a["increment"]) for a, b in zip(auto, auto[1:]) if a["name"] == b["name"]]
assert max(taken) >= 8, taken
assert auto[-1]["increment"] == "9" and any(r["name"] == "press" and r["increment"] == "23" for r in auto)
for column in ("bottom_y", "left_x", "top_y", "dilatancy", "uy_top"):
    scale = max(abs(float(r[column])) for r in plan)
    for r in auto:
        p = at[r["name"], r["increment"]]
        assert abs(float(r[column]) - float(p[column])) <= 1e-8 * scale, (column, r[column], p[column])
E
/usr/bin/python3 "$work/compare.py" "$work/planned/history.csv" "$work/automatic/history.csv"
say $? 'automatic ones are fewer, take up to 8 and more at once, and pass through the same states'
# With 12 iterations at most, those of up to 4 are easy and those of 7 and more are hard. Large increments of grains that are relaxed are.
hard=$(printf '%s' "$head" | sed 's/^steps:.*/steps: [{name: press, increments: 24, displace: [{edge: top, y: -0.4}]}]/')
printf '%s\n%s\nmicro: {boundary: restricted, engine: native}\nsolver: {increments: automatic, max_iterations: 12}\n' "$hard" "$smooth" >"$work/hard.yaml"
"$granhom" run "$work/hard.yaml" -o "$work/hard" >/dev/null 2>"$work/err"
say $? 'automatic increments that are hard for the packings'
cat >"$work/rule.py" <<'E'
import csv, sys
rows = [r for r in csv.DictReader(open(sys.argv[1])) if r["name"] == "press"]
ends, least, most = [0] + [int(r["increment"]) for r in rows], [], []
taken, allowed, shrunk = [b - a for a, b in zip(ends, ends[1:])], 1, 0
assert ends[-1] == 24
for n, r in zip(taken, rows):
    assert n == min(allowed, 24 - (int(r["increment"]) - n)), (n, allowed, r["increment"])
    hard = int(r["cuts"]) > 0 or int(r["jumps"]) > 0 or int(r["iterations"]) > 6
    easy = not hard and int(r["iterations"]) <= 4
    shrunk += hard and allowed > 1
    allowed = max(1, allowed // 2) if hard else min(16, 2 * allowed) if easy else allowed
print("#", taken, [(r["iterations"], r["cuts"], r["jumps"]) for r in rows])
assert max(taken) > 1 and shrunk > 0, taken
E
/usr/bin/python3 "$work/rule.py" "$work/hard/history.csv"; say $? 'grow after easy ones, shrink after hard ones, and end where the step ends'
# Stopped as soon as each increment is on disk, and restarted: how many to take at once is remembered.
stops=0
code=1
while [ $stops -lt 20 ] && [ $code != 0 ]; do
  rows=$(cat "$work/again/history.csv" 2>/dev/null | wc -l)
  "$granhom" run "$work/hard.yaml" -o "$work/again" --restart >/dev/null 2>"$work/err" &
  while kill -0 $! 2>/dev/null && [ "$(cat "$work/again/history.csv" 2>/dev/null | wc -l)" -le "$rows" ]; do sleep 0.01; done
  kill -INT $! 2>/dev/null
  wait $!
  code=$?
  stops=$((stops + 1))
done
[ $code = 0 ] && cmp -s "$work/hard/history.csv" "$work/again/history.csv"; say $? 'stopped and restarted, they are the same to the last digit'

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
grep -q 'MPI no' "$work/said" && grep -q 'HDF5 no' "$work/said"; say $? '--version states so'

printf '%s\ncontact: {normal_stiffness: 50}\nmicro: {boundary: taylor-cell}\n' "$head" >"$work/s.yaml"
"$granhom" run "$work/s.yaml" -o "$work/full" >/dev/null 2>&1
say $? 'a scene runs in the full build'
"$lean" run "$work/s.yaml" -o "$work/out" >/dev/null 2>"$work/err"
say $? 'the same scene runs without MPI and HDF5'
grep -q 'built without HDF5' "$work/err"; say $? 'and states what is not written'
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
printf '%s\ncontact: {normal_stiffness: 50}\nmicro: {engine: native}\n' "$head" >"$work/n.yaml"
# MPI_Init makes a folder for its session: Open MPI 4 the first, Open MPI 5 something in the second
mkdir "$work/tmp"
session() { OMPI_MCA_orte_tmpdir_base=$work/session TMPDIR=$work/tmp "$lean" run "$@" >/dev/null 2>&1; }
session "$work/n.yaml" -o "$work/native" && [ ! -e "$work/session" ] && [ -z "$(ls -A "$work/tmp")" ]
say $? 'with the native engine nobody starts MPI'
session "$work/s.yaml" -o "$work/out" && { [ -e "$work/session" ] || [ -n "$(ls -A "$work/tmp")" ]; }
say $? 'with LAMMPS, LAMMPS does'
OMPI_COMM_WORLD_SIZE=2
export OMPI_COMM_WORLD_SIZE
refused 'without MPI.*on 2 ranks' "$lean" run "$work/s.yaml" -o "$work/two"
say $? 'started on two ranks, it refuses'
[ ! -e "$work/two" ]; say $? 'and writes nothing'
[ "$failed" = 0 ]
