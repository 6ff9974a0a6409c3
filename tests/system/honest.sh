#!/usr/bin/env bash
# What looks done and is not: forces that are round-off, results over inputs, pictures of a run that stopped before its driven step, a
# script without an end. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, ok, not_ok, check
begin
friction=$root/tests/data/friction-paths
cp "$root/tests/data/cases/packings/p50.data" p.data

# A path on which the packing comes apart: rows without contact forces to speak of are stress-free, the others in equilibrium. What
# follows the first unjammed state hangs on the last bit: in the arithmetic of other compilers and of sanitizers the path may end earlier,
# and states so.
"$granhom" rve "$friction/n100_p1e-3_s1.data" --path "$friction/p50old.csv" --engine native --friction-coefficient 0.5 --tangential-stiffness 0.2 \
  -o o.csv >said 2>&1
code=$?
[ $code = 1 ] && grep -q '^granhom: step [0-9]*: .*no equilibrium within' said && code=0
check "a path into the unjammed: exit 0" test $code = 0
/usr/bin/python3 - <<'P'
import csv, re, sys
free = set(int(n) for n in re.findall(r"step (\d+): unjammed", open("said").read()))
rows = list(csv.DictReader(open("o.csv")))
worst = max(float(r["residual"]) for r in rows)
silent = [r["step"] for r in rows if max(abs(float(r[k])) for k in ("P11", "P22")) < 1e-11 and int(r["step"]) not in free]
print("# largest residual %.2g, stress-free without a word: %s, reported: %d" % (worst, silent, len(free)))
sys.exit(not (worst <= 3e-8 and not silent and 0 < len(free) < len(rows)))
P
check "residuals within the tolerance, rows without stress reported as unjammed" test $? = 0

# A path in which slip over a whole increment has no equilibrium, nor a relaxation that commits it an end in reasonable time.
"$granhom" rve "$friction/n100_p1e-3_s1.data" --path "$friction/p100.csv" --engine native --friction-coefficient 0.5 --tangential-stiffness 0.2 \
  -o o.csv >said 2>&1
check "creeping grains come to rest" test $? = 0
check "all of its increments are in equilibrium" awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) c[$k] = k; next } !($c["residual"] <= 1e-8) { exit 1 }
  { ramps += $c["ramps"] } END { exit !(NR == 102 && ramps > 50) }' o.csv

# Results are not written over inputs, by whatever name.
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.99,0,0,1\n' >path.csv
printf 'steps: [{increments: 1, control: {F11: 0.99, F22: 0.99, F12: 0}}]\n' >control.yaml
printf 'diameter,count\n0.5,40\n' >sieve.csv
ln -s path.csv linked.csv
kept() { # NAME FILE COMMAND...
  local name=$1 file=$2 before code
  shift 2
  before=$(cksum <"$file")
  "$granhom" "$@" >said 2>&1
  code=$?
  if [ $code = 2 ] && [ "$(grep -c '^granhom: .*is an input' said)" = 1 ] && [ "$(cksum <"$file")" = "$before" ]; then ok "$name is kept"
  else not_ok "$name is kept" "exit $code" "$(tail -n 3 said)"; fi
}
kept "a path" path.csv rve p.data --path path.csv --engine native -o path.csv
kept "a path by another name" path.csv rve p.data --path path.csv --engine native --dump ./linked.csv
kept "a packing" p.data rve p.data --path path.csv --engine native --tangent p.data -o o.csv
has HDF5 "a packing, for a state, is kept" && kept "a packing, for a state" p.data rve p.data --path path.csv --engine native --save-state ../"${PWD##*/}"/p.data -o o.csv
kept "a control" control.yaml element p.data --control control.yaml -o control.yaml
kept "a sieve curve" sieve.csv pack --sieve sieve.csv --dimension 2 -o sieve.csv

# A run that stops before the step that drives: its curves are drawn over load steps.
cat >early.yaml <<S
packing: p.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor-cell, engine: native}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: press, increments: 4, pressure: [{edge: right, to: 15}, {edge: top, to: 15}]}
  - {name: drive, increments: 1, displace: [{edge: top, x: 0.1}]}
S
"$granhom" run early.yaml -o early --quiet >said 2>&1
check "a run that stops in its first step: exit 1" test $? = 1
check "it is drawn" "$granhom" plot early
has HDF5 "its report" && check "and reported" "$granhom" report early

# Names in a comment, a single row, blanks.
printf '# F11 F12 F21 F22\n0.99 0 0 0.99\n' >blanks.csv
printf 'F11,F12,F21,F22\n0.99,0,0,0.99\n' >commas.csv
for k in blanks commas; do "$granhom" rve p.data --path $k.csv --engine native --boundary taylor 2>said | cut -d, -f1-17 >$k.out; done
if [ -s blanks.out ] && cmp -s blanks.out commas.out && [ "$(wc -l <blanks.out)" = 2 ]; then ok "a table of one row with blanks"
else not_ok "a table of one row with blanks" "$(cat said)"; fi

# A condition without a value, which looks like one of the next line.
printf 'steps:\n  - {increments: 2, control: {s11: , s22: -0.3, s12: 0}}\n' >empty.yaml
refused_by element "a condition without a value" "empty.yaml:2: s11 must be a number" ../p.data --control ../empty.yaml -o o.csv

# LAMMPS hands indices below 1 to a fix.
sed -e 's/^thermo_style .*/thermo_style custom step f_relax[-1]/' "$root/lammps-inputs/in.compress" >in.index
cp "$root"/lammps-inputs/*.data . 2>/dev/null
timeout 60 "$granhom" lammps -in in.index -log none -screen none >said 2>&1
check "an index that no fix has" grep -q "granhom/relax has no value -1" said
timeout 20 "$granhom" lammps -in /dev/zero -log none >said 2>&1
check "a device is no script: exit 2" test $? = 2
exit $bad
