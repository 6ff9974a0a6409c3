#!/usr/bin/env bash
# plot and report on files that are cut, empty, half written or of another program: one message, exit 2, no picture and no page.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. tests/shell.sh
begin
command -v gnuplot >/dev/null || { echo "skip - no gnuplot"; exit 0; }
cp "$root/tests/data/cases/packings/block150.data" p.data || exit 1
cat >scene.yaml <<S
packing: p.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor-cell, engine: native}
start: {balance: true}
mesh: {rectangle: {size: [10, 10], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: a, increments: 3, displace: [{edge: top, y: -0.1}]}
  - {name: b, increments: 2, displace: [{edge: top, y: -0.2}]}
S
check "a run" "$granhom" run scene.yaml -o whole --quiet
cp -r whole twin
check "the whole folder is drawn" "$granhom" plot twin
commands=plot
has HDF5 report && commands="plot report" && check "and reported" "$granhom" report twin

refuses() { # NAME WORDS: the folder `f` as it is now
  local code command
  for command in $commands; do
    "$granhom" $command f >said.out 2>said.err
    code=$?
    if [ $code = 2 ] && grep -q -- "$2" said.err && [ "$(wc -l <said.err)" = 1 ] && [ ! -s said.out ] && ! ls f | grep -q 'png$\|html$'; then ok "$command: $1"
    else not_ok "$command: $1" "exit $code" "$(head -n 3 said.err)" "wanted: $2" "$(ls f)"; fi
  done
  "$granhom" plot f -o made >/dev/null 2>&1
  if [ ! -e made ]; then ok "no folder for pictures: $1"; else not_ok "no folder for pictures: $1"; rm -rf made; fi
}
fresh() { rm -rf f && cp -r whole f; }
half() { head -c $(($(wc -c <whole/"$1") / 2)) whole/"$1" >f/"$1"; }

for name in history.csv convergence.csv; do
  fresh; half $name; refuses "$name cut in the middle" "^granhom: f/$name: .*cut off"
  fresh; : >f/$name; refuses "$name is empty" "^granhom: f/$name: the file is empty"
  fresh; rm f/$name; refuses "$name is missing" "^granhom: f/$name: "
  fresh; head -c -1 whole/$name >f/$name; refuses "$name without the end of its last line" "^granhom: f/$name: the last line is cut off"
  fresh; head -n 3 whole/$name >f/$name; refuses "$name cut at the end of a line" "^granhom: f/$name: is cut off: it"
  fresh; head -n 1 whole/$name >f/$name; refuses "$name with its header alone" "^granhom: f/$name: holds no"
  fresh; printf 'a,b\n1,2\n' >f/$name; refuses "$name of another program" "^granhom: f/$name: "
  fresh; head -c 2000 /dev/zero >f/$name; refuses "$name of zeros" "^granhom: f/$name:1: not a text file"
done
# number COLUMN VALUE: in the fourth line of f/history.csv
number() { awk -F, -v OFS=, -v name="$1" -v value="$2" 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == name) c = k } NR == 4 { $c = value } 1' f/history.csv >h && mv h f/history.csv; }
fresh; number top_y nan; refuses "a force that is no number" "^granhom: f/history.csv:4: top_y: 'nan' is not a finite number"
fresh; number uy_top inf; refuses "a displacement that is not finite" "^granhom: f/history.csv:4: uy_top: 'inf' is not a finite number"
fresh; number uy_top -nan; refuses "a displacement that is no number" "^granhom: f/history.csv:4: uy_top: '-nan' is not a finite number"
fresh; sed -i '1s/uy_top/uy_tip/' f/history.csv; refuses "no column for the driven set" "^granhom: f/history.csv: has no column uy_top, and run.json has 'top' as the driven set"
fresh; half run.json; refuses "run.json cut" "^granhom: f/run.json: is no JSON object"
fresh; : >f/run.json; refuses "run.json empty" "^granhom: f/run.json: the file is empty"
fresh; echo '[1, 2]' >f/run.json; refuses "run.json of another program" "^granhom: f/run.json: is no JSON object"
fresh; rm f/run.json; refuses "run.json missing" "^granhom: f: holds no results"
for name in results.h5 rves.h5 traces.h5; do
  [ -e whole/$name ] || continue
  fresh; half $name; refuses "$name cut" "^granhom: f/$name: "
  fresh; : >f/$name; refuses "$name empty" "^granhom: f/$name: "
  fresh; cp p.data f/$name; refuses "$name of another program" "^granhom: f/$name: "
done

# what belongs to a shorter run
sed 's/increments: 2/increments: 1/' scene.yaml >short.yaml
check "a shorter run" "$granhom" run short.yaml -o short --quiet
if [ -e whole/results.h5 ]; then
  fresh; cp short/results.h5 f; refuses "results.h5 of a shorter run" "results.h5: is cut off: it has no increment 5"
fi
fresh; cp short/history.csv f; refuses "history.csv of a shorter run" "history.csv: is cut off: it has 4 increments after the start, run.json has counted 5"

# what is right stays right: a run that is under way, one without recorded packings
fresh
sed -i 's/"status":[^,]*,/"status": "running",/' f/run.json
check "a run that is under way is drawn" "$granhom" plot f
sed '$a results: {rves: none}' scene.yaml >none.yaml
check "a run without recorded packings" "$granhom" run none.yaml -o none --quiet
"$granhom" plot none >said.out 2>said.err
code=$?
if [ $code = 0 ] && grep -q 'no rve.png' said.err && [ -s none/curves.png ]; then ok "is drawn without rve.png, which is said"
else not_ok "is drawn without rve.png, which is said" "exit $code" "$(cat said.err)"; fi
exit $bad
