#!/usr/bin/env bash
# Outputs do no harm: none is written over an input, a result of another kind or another output, whatever its name is; what must be a
# file is not waited for where a pipe lies; pipes that are meant as outputs are written into.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. tests/shell.sh
begin memory
h5= && has HDF5 'states, reports' && h5=1
cp "$root/tests/data/cases/packings/p20.data" p.data || exit 1
cp "$root/tests/data/cases/packings/block150.data" b.data
printf 'F11,F12,F21,F22\n1,0,0,1\n0.999,0,0,1\n' >path.csv
printf 'steps: [{increments: 1, control: {F11: 0.999, F22: 1, F12: 0}}]\n' >control.yaml
printf 'diameter,count\n1,6\n' >sieve.csv
printf 'sieve: sieve.csv\n' >pack.yaml
printf 'rve:\n  packing: p.data\n  contact: {normal_stiffness: 1}\n  micro: {boundary: periodic, engine: native}\n  path: {file: path.csv}\nvary: {micro.tolerance: [1e-6]}\nreference: {set: {micro.tolerance: 1e-9}}\n' >study.yaml
cat >scene.yaml <<Y
packing: b.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor-cell, engine: native}
start: {balance: true}
mesh: {rectangle: {size: [10, 10], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps: [{name: a, increments: 1, displace: [{edge: top, y: -0.05}]}]
Y
check "a run" "$granhom" run scene.yaml -o r --quiet
check "a study" "$granhom" study study.yaml -o s --quiet
has HDF5 && check "a state" "$granhom" rve p.data --path path.csv --engine native --save-state state.h5 -o old.csv
ln -s r/history.csv linked.csv
ln b.data hard.data
everything() { find . -type f ! -name 'said*' -exec cksum {} + | sort; }
# refuses WORDS COMMAND...: exit 2 at once, one message with WORDS, no file changed, made or removed
refuses() {
  local words=$1 before code
  shift
  before=$(everything)
  timeout -s KILL 20 "$granhom" "$@" >said.out 2>said.err </dev/null
  code=$?
  if [ $code = 2 ] && grep -qF -- "$words" said.err && [ "$(grep -c ^granhom said.err)" = 1 ] && [ "$(everything)" = "$before" ]; then ok "$*"
  else not_ok "$*" "exit $code" "$(head -n 3 said.err)" "wanted: $words" "$(diff <(echo "$before") <(everything))"; fi
}
rve=(rve p.data --path path.csv --engine native)

# --- results and inputs ---
for name in r/history.csv r/run.json r/convergence.csv ./r/../r/history.csv linked.csv ${h5:+r/results.h5 r/checkpoint.h5 r/rves.h5}; do
  [ -z "$h5" ] || refuses "$name: " report r -o "$name"
  refuses "$name: is an input" compare r r -o "$name"
  refuses "$name: " "${rve[@]}" -o "$name"
done
refuses 'r/points.xdmf: ' "${rve[@]}" --dump r/points.xdmf
refuses 's/study.csv: has the name of a file of the results' "${rve[@]}" -o s/study.csv
for file in b.data scene.yaml study.yaml pack.yaml control.yaml ${h5:+state.h5}; do refuses "$file: looks like" "${rve[@]}" -o "$file"; done
[ -z "$h5" ] || refuses 'b.data: looks like a packing' report r -o b.data
refuses 'sieve.csv: looks like a sieve curve' "${rve[@]}" --tangent sieve.csv
refuses 'pack.yaml: is an input' pack pack.yaml -o pack.yaml
refuses 'pack.yaml: is an input' pack pack.yaml -o "$PWD/pack.yaml" --quiet
refuses 'hard.data: looks like' element p.data --control control.yaml --engine native -o hard.data
[ -z "$h5" ] || refuses 'state.h5: is an input' "${rve[@]}" --load-state state.h5 --save-state ./state.h5
before=$(cksum <path.csv)
"$granhom" rve p.data --path - --engine native -o path.csv <path.csv 2>said.err
check 'standard input is an input too' test $? = 2 -a "$(cksum <path.csv)" = "$before"
mkdir q && cp scene.yaml q/run.json && sed -i 's|b.data|../b.data|' q/run.json
refuses 'q/run.json: is an input' run q/run.json -o q
refuses 'q/run.json: is an input' run q/run.json -o "$PWD/./q/"
rm q/run.json && ln b.data q/results.h5 && sed 's|b.data|q/results.h5|' scene.yaml >other.yaml
refuses 'q/results.h5: is an input' run other.yaml -o q
sed 's|path.csv|curves.csv|; s|p.data|../p.data|' study.yaml >q/again.yaml && cp path.csv q/curves.csv
refuses 'q/curves.csv: is an input' study q/again.yaml -o q
mkdir c && cp path.csv c/refine.csv
refuses 'c/refine.csv: is an input' crosscheck p.data --path c/refine.csv --engines native,gran -o c
refuses 's: holds the results of `granhom study`' run scene.yaml -o s
refuses 'r: holds the results of `granhom run`' study study.yaml -o r
check 'an old table is replaced' "$granhom" "${rve[@]}" -o old.csv
check 'a run in its own folder is repeated' "$granhom" run scene.yaml -o r --quiet
check 'a study too' "$granhom" study study.yaml -o s --quiet
[ -z "$h5" ] || check 'a page twice' sh -c "'$granhom' report r -o page.html && '$granhom' report r -o page.html"

# --- two results in one file ---
ln -s new.csv to_new.csv
mkdir below
for name in ./new.csv "$PWD/new.csv" below/../new.csv to_new.csv; do
  for option in tangent dump ${h5:+save-state}; do refuses "$name: two of the results" "${rve[@]}" -o new.csv --$option "$name"; done
done
[ -z "$h5" ] || refuses './o.csv: two of the results' element p.data --control control.yaml --engine native -o o.csv --save-state ./o.csv
refuses './k.png: two of the results' pack pack.yaml -o k.png --picture ./k.png
refuses './k-001.png: two of the results' pack pack.yaml -o k.png --picture ./k.png --ensemble 2
refuses './x.csv: two of the results' compare r r -o x.csv --picture ./x.csv

# --- pipes where files must be ---
mkfifo pipe
if [ -n "$h5" ]; then
  refuses 'pipe: is a device or a pipe' "${rve[@]}" --load-state pipe
  refuses 'pipe: is a device or a pipe' element p.data --control control.yaml --engine native --load-state pipe
fi
for name in history.csv run.json convergence.csv ${h5:+results.h5 rves.h5 checkpoint.h5}; do
  rm -rf t && cp -r r t && rm t/$name && mkfifo t/$name
  refuses "t/$name: is a device or a pipe" run scene.yaml -o t
  refuses "t/$name: is a device or a pipe" run scene.yaml -o t --restart
  [ $name = checkpoint.h5 ] && continue # no picture is made of it
  case $name in *.h5) ;; *) refuses "t/$name: is a device or a pipe" plot t ;; esac
  [ -z "$h5" ] || refuses "t/$name: is a device or a pipe" report t
done
record=$(ls s/runs/*.json | head -n 1)
rm "$record" && mkfifo "$record"
refuses "$record: is a device or a pipe" study study.yaml -o s
if "$granhom" --version | grep -q '^LAMMPS'; then
  refuses 'cannot open the input script pipe: a pipe that nothing' lammps -in pipe
  echo 'print "from a pipe"' >in.print
  check 'a script in a pipe' sh -c "'$granhom' lammps -in pipe -log none | grep -q 'from a pipe' & cat in.print >pipe; wait \$!"
fi

# --- outputs that are pipes ---
columns() { cut -d, -f1-17 "$1"; }
check 'the table' "$granhom" "${rve[@]}" -o table.csv
"$granhom" "${rve[@]}" -o /dev/stdout 2>said.err | cat >piped.csv
check 'into a pipe as /dev/stdout' cmp <(columns table.csv) <(columns piped.csv)
"$granhom" "${rve[@]}" -o table.csv --tangent >(cat >tangent.csv; : >ended) 2>said.err
for _ in $(seq 100); do [ -e ended ] && break; sleep 0.05; done
check 'into a pipe of the shell: each row once' test "$(wc -l <tangent.csv)" = 3
check 'both into /dev/null' "$granhom" "${rve[@]}" -o /dev/null --tangent /dev/null
check 'it stays a device' test -c /dev/null

# --- names of folders ---
for name in . below/ below/.. nowhere/; do refuses "$name: is the name of a folder" "${rve[@]}" -o "$name"; done
exit $bad
