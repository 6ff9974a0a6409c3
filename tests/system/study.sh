#!/usr/bin/env bash
# granhom study: one packing and a scene on one and two ranks, records that survive kill -9, failures, wrong input.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say
begin
export OMPI_MCA_mpi_yield_when_idle=1
packings=$root/tests/data/cases/packings
records() { find "$1/runs" -name '*.json' 2>/dev/null | wc -l; }
# until COUNT DIR: waits for so many records, 15 s at most
until_records() { for _ in $(seq 300); do [ "$(records "$2")" -ge "$1" ] && return; sleep 0.05; done; }

cat >rve.yaml <<E
title: Tolerance of a packing
rve:
  packing: $packings/p50.data
  contact: {normal_stiffness: 50}
  micro: {boundary: periodic, engine: native}
  path: {legs: [{to: [0.98, 0, 0, 1], increments: 4}]}
vary:
  micro.tolerance: [1e-1, 1e-3, 1e-6]
  micro.boundary: [taylor-cell, periodic]
  micro.max_steps: [400000, 2]
reference: {set: {micro.tolerance: 1e-11}}
quick: {vary: {micro.tolerance: [1e-1]}, base: {micro.boundary: taylor-cell}}
E
cat >scene.yaml <<E
packing: $packings/p50.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor, engine: native}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [1, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: press, increments: 2, pressure: [{edge: right, to: 0.32, follow: true}, {edge: top, to: 0.31}]}
  - {name: shear, increments: 4, displace: [{edge: top, x: 0.05}]}
E
cat >block.yaml <<E
scene: scene.yaml
vary:
  mesh.rectangle.elements: [[1, 1], [2, 2]]
  refine: [1, 2]
base: {solver.tolerance: 1e-10}
reference: {set: {mesh.rectangle.elements: [4, 4]}}
order: refine
plots: [force_x]
E

# --- one process ---
"$granhom" study rve.yaml -o rve1 >said 2>err; say $? 'a study of one packing runs'
[ "$(grep -c 'of 16: micro' err)" = 16 ] && grep -q '^16 of 16: .* s' err; say $? 'one line for each run that is finished'
grep -q '^For 1 % of the stress: ' said && [ "$(grep -c . rve1/study.csv)" = 17 ]; say $? 'sentences on the screen, a row for each configuration and each reference in study.csv'
grep -q 'no equilibrium within 2 relaxation steps' rve1/study.md; say $? 'runs that failed are listed with their reason, and the study is done'
[ "$(records rve1)" = 16 ]; say $? 'each run has a record'
if command -v gnuplot >/dev/null; then [ -s rve1/work-precision.png ]; say $? 'a picture is drawn'; fi
"$granhom" study rve.yaml -o rve1 >again 2>err; say $? 'again'
! grep -q 'of 16: ' err && cmp -s said again; say $? 'finished runs are not repeated, and the words are the same'
if [ -c /dev/full ]; then
  "$granhom" study rve.yaml -o rve1 2>err >/dev/full; [ $? = 1 ] && [ "$(grep -c '^granhom: standard output cannot be written' err)" = 1 ]; say $? 'a screen that is full is reported'
fi
"$granhom" study rve.yaml -o quick --quick >said 2>err; say $? '--quick runs'
[ "$(grep -c 'of 2: ' err)" = 2 ] && [ "$(grep -c . quick/study.csv)" = 3 ]; say $? 'and has its own configurations'
"$granhom" study rve.yaml --explain >said 2>err && grep -q 'configurations: 12, and 4 more as references; 16 runs in all' said &&
  grep -q 'reference: the same with micro.tolerance 1e-11' said
say $? '--explain prints configurations, references and runs'
"$granhom" study block.yaml -o block1 --quiet >said 2>err && [ ! -s said ] && [ ! -s err ]; say $? 'a study of a scene runs, and is silent with --quiet'
"$granhom" run scene.yaml -o run --quiet 2>err
sed 's/\[1, 1\], \[2, 2\]/[1, 2], [2, 2]/; /^base/d' block.yaml >same.yaml
"$granhom" study same.yaml -o same --quiet 2>err; say $? 'the same scene as in a run'
/usr/bin/python3 - <<'P' 2>err
import csv, glob, json
run = list(csv.DictReader(open("run/history.csv")))
records = [json.load(open(f)) for f in glob.glob("same/runs/*.json")]
[record] = [r for r in records if r["overrides"] == {"mesh.rectangle.elements": "[1, 2]", "refine": "1"}]
columns = record["columns"]
assert columns == ["t", "P11", "P12", "P21", "P22", "force_x", "force_y", "dilatancy"], columns
assert len(record["curve"]) == len(run) == 7
for row, ours in zip(run, record["curve"]):
    for name, column in (("time", "t"), ("top_x", "force_x"), ("top_y", "force_y"), ("dilatancy", "dilatancy")):
        assert float(row[name]) == ours[columns.index(column)], (name, row[name], ours)
# u = (X, 0) is a virtual displacement of the first step: the follower load on the right edge is the mean of P11 but for the
# turn and stretch of that edge
assert abs(record["curve"][2][1] + 0.32) < 0.01, record["curve"][2]
last = json.load(open("run/run.json"))
summary, error = last["summary"], last["error"]
for key in ("residual", "energy_defect"):  # run.json may lack the last bit
    assert abs(record[key] - error[key]) <= 1e-15 * abs(error[key]) > 0, (key, record[key], error[key])
assert [record[k] for k in ("iterations", "factorisations", "evaluations", "pair_evaluations")] == [summary[k] for k in ("iterations", "factorisations", "evaluations", "pair_evaluations")]
P
say $? 'force, dilatancy and counts are those of granhom run, to the last bit'

# --- wrong input: exit 2 and nothing written ---
wrong() { # wrong FILE WORDS
  "$granhom" study "$1" -o wrong >said 2>err
  [ $? = 2 ] && grep -q "^granhom: .*$2" err && [ "$(grep -c '^granhom' err)" = 1 ] && [ ! -e wrong ] && [ ! -s said ]; say $? "refused: $2"
}
sed 's/scene.yaml/none.yaml/' block.yaml >w.yaml; wrong w.yaml 'w.yaml:1: ./none.yaml: cannot be opened'
sed 's/order: refine/order: x/' block.yaml >w.yaml; wrong w.yaml "w.yaml:7: order: 'x' is none of the keys under vary"
wrong nothing.yaml 'nothing.yaml: cannot be opened'
sed 's/tolerance: \[1e-1/tolerance: [3/' rve.yaml >w.yaml; wrong w.yaml 'w.yaml:8: micro.tolerance: 3: w.yaml:5: tolerance is 3, it must be below 1'
"$granhom" study rve.yaml 2>err; [ $? = 2 ] && grep -q -e '-o DIR is needed' err; say $? 'refused: no folder'
: >file; "$granhom" study rve.yaml -o file >said 2>err; [ $? = 2 ] && grep -q 'file: .*folder' err; say $? 'refused: a file in the place of the folder'
"$granhom" study rve.yaml -o '' >said 2>err; [ $? = 2 ] && grep -q 'the name of the folder for results is empty' err && [ ! -e runs ]; say $? 'refused: a folder without a name'
mkdir busy && : >busy/runs; "$granhom" study rve.yaml -o busy >said 2>err; [ $? = 2 ] && [ "$(find busy | wc -l)" = 2 ]; say $? 'refused: a file in the place of the records'
(ulimit -f 2; trap '' XFSZ; "$granhom" study rve.yaml -o tight --quiet 2>&1; echo "exit $?") | cat >err
grep -q '^exit 1$' err && [ "$(grep -c '^granhom: .*cannot write' err)" = 1 ] && [ -z "$(find tight -name '*.tmp')" ]; say $? 'a disk that is full: exit 1, one message, nothing half written'
"$granhom" study rve.yaml -o tight --quiet 2>err && [ "$(records tight)" = 16 ]; say $? 'and the study continues when there is room'
sed 's/400000, 2\]/1, 2]/; s/\[taylor-cell, periodic\]/[periodic]/; s/engine: native/&, relaxation: damped/' rve.yaml >none.yaml
"$granhom" study none.yaml -o none >said 2>err
[ $? = 1 ] && grep -q '^granhom: no configuration has a result; the first one, micro.tolerance 1e-1' err; say $? 'exit 1 when no configuration has a result'
[ -s none/study.md ]; say $? 'and the table states why'

sed 's/^reference.*/reference: {set: {micro.max_steps: 2}}/; /400000/d; s/engine: native/&, relaxation: damped/' rve.yaml >lame.yaml
"$granhom" study lame.yaml -o lame >said 2>err; say $? 'a study whose references fail is done'
grep -q '^reference micro.tolerance 1e-6, micro.boundary periodic, micro.max_steps: 2: t = 1: no equilibrium' said
say $? 'and states why the references have failed'

# --- a run that the system refuses is no result: the other rows are there, and the status shows it ---
sed '/^vary:/,/^quick:/d' rve.yaml >refused.yaml
printf 'vary: {micro.engine: [native, liggghts]}\nreference: {set: {micro.tolerance: 1e-11, micro.engine: native}}\n' >>refused.yaml
PATH=/nowhere "$granhom" study refused.yaml -o refused --quiet >said 2>err
[ $? = 1 ] && grep -q '^granhom: the system refused 1 of 3 runs; the first one, micro.engine liggghts: ' err && [ "$(records refused)" = 2 ] &&
  [ "$(grep -c ',done,1,1,5,' refused/study.csv)" = 1 ] && [ "$(grep -c ',failed,1,0,' refused/study.csv)" = 1 ]
say $? 'a program that is not installed: exit 1 with the rows of the others'
mkdir -p unwritable/work-precision.png
"$granhom" study refused.yaml -o unwritable --quiet >said 2>err
code=$?
if ! command -v gnuplot >/dev/null; then echo 'skip - a picture that cannot be written (no gnuplot)'
else [ $code = 1 ] && grep -q '^granhom: unwritable/work-precision.png: cannot write: ' err && [ -s unwritable/study.md ]; say $? 'a picture that cannot be written: exit 1'; fi

# --- stopped and killed ---
sed 's/increments: 4}\]/increments: 3000}]/; s/\[400000, 2\]/[400000, 300000]/; s/: 1e-11/: 1e-10/' rve.yaml >long.yaml
"$granhom" study long.yaml -o long >said 2>err &
job=$!
until_records 3 long
kill -TERM $job; wait $job; code=$?
[ $code = 1 ] && grep -q '^granhom: stopped on request: [0-9]* of 16 runs are finished and kept' err; say $? 'SIGTERM: exit 1, finished runs stay'
kept=$(records long)
"$granhom" study long.yaml -o long >said 2>err &
job=$!
until_records $((kept + 1)) long
kill -9 $job; wait $job 2>/dev/null
kept=$(records long) left=$((16 - $(records long)))
"$granhom" study long.yaml -o long >said 2>err; say $? "after kill -9 the study continues with $kept records"
[ "$kept" -lt 16 ] && [ "$(grep -c "of $left: micro" err)" = $left ]; say $? 'and repeats only what is missing'
sed -i 's/"wall_seconds": /&1/' "$(find long/runs -name '*.json' | sort | head -n 1)"
"$granhom" study long.yaml -o long >said 2>err && [ "$(grep -c 'of 1: ' err)" = 1 ]; say $? 'a damaged record is repeated'

# --- several ranks ---
if ! command -v mpirun >/dev/null || ! "$granhom" --version | grep -q 'MPI yes' || ! mpirun -n 2 true 2>err; then
  echo 'skip - mpirun does not start here'
  exit $bad
fi
cat >same.py <<'P'
"""same.py A B: study.csv but for seconds (and the front by them), curves.csv, and records but for seconds are the same."""
import csv, json, os, sys
def table(folder):
    rows = list(csv.DictReader(open(f"{folder}/study.csv")))
    return [{k: v for k, v in r.items() if k not in ("wall", "core", "pareto")} for r in rows]
def record(folder, name):
    r = json.load(open(f"{folder}/runs/{name}"))
    return {k: v for k, v in r.items() if "seconds" not in k and k != "check"}
a, b = sys.argv[1:]
assert len(table(a)) > 0
for x, y in zip(table(a), table(b), strict=True):
    assert x == y, [(k, x[k], y[k]) for k in x if x[k] != y[k]]
assert open(f"{a}/curves.csv").read() == open(f"{b}/curves.csv").read()
assert sorted(os.listdir(f"{a}/runs")) == sorted(os.listdir(f"{b}/runs"))
for name in os.listdir(f"{a}/runs"):
    assert record(a, name) == record(b, name), name
P
for name in rve block; do
  timeout 120 mpirun -n 2 "$granhom" study $name.yaml -o ${name}2 >said 2>err; say $? "$name on two ranks"
  /usr/bin/python3 same.py ${name}1 ${name}2 2>err; say $? 'the same tables and records but for seconds'
done
timeout 120 mpirun -n 3 "$granhom" study rve.yaml -o rve2 >said 2>err && ! grep -q 'of 16: ' err; say $? 'records serve any number of ranks'
cat >each.sh <<'S'
"$@"
echo $? >code.$OMPI_COMM_WORLD_RANK
S
timeout 60 mpirun -n 3 sh each.sh "$granhom" study w.yaml -o wrong >said 2>err
[ "$(cat code.0 code.1 code.2 | tr '\n' ' ')" = '2 2 2 ' ] && [ "$(grep -c '^granhom' err)" = 1 ] && [ ! -e wrong ]; say $? 'wrong input on three ranks: exit 2 on all, reported once'
mkdir 0 1 && for d in 0 1; do sed "s|packing: .*|packing: 'p*.data'|" rve.yaml >$d/s.yaml; cp "$packings/p50.data" $d; done; cp "$packings/p20.data" 1
echo 'cd $OMPI_COMM_WORLD_RANK && "$@"; echo $? >code' >apart.sh # a folder for each rank
timeout 60 mpirun -n 2 sh apart.sh "$granhom" study s.yaml -o o >said 2>err
[ "$(cat 0/code 1/code | tr '\n' ' ')" = '2 2 ' ] && [ "$(grep -c '^granhom: the ranks have read different studies' err)" = 1 ] && [ ! -e 0/o ] && [ ! -e 1/o ]
say $? 'ranks that see different files: exit 2 on all, reported once'
timeout 60 mpirun -n 4 "$granhom" study rve.yaml -o few --quick --quiet >said 2>err && [ "$(records few)" = 2 ]; say $? 'more ranks than runs'
mpirun -n 2 sh -c 'echo $$ >pid.$OMPI_COMM_WORLD_RANK; exec "$@"' sh "$granhom" study long.yaml -o long2 >said 2>err &
job=$!
until_records 2 long2
kill -TERM "$(cat pid.1)" # one rank alone: the other hears of it
timeout 20 tail --pid=$job -f /dev/null; wait $job; code=$?
[ $code = 1 ] && [ "$(grep -c '^granhom: stopped on request' err)" = 1 ]; say $? 'SIGTERM to one rank ends both, with one message and exit 1'
exit $bad
