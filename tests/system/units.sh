#!/usr/bin/env bash
# Nonsense units and what can be known before a computation: overlaps, stresses against the stiffness, tensions, strains that no
# packing follows, free edges, places that cannot be written to. SPDX-License-Identifier: GPL-2.0-or-later
. tests/shell.sh
begin memory
p=$root/tests/data/cases/packings/block150.data
dense=$root/tests/data/cases/packings/p50d.data
export OMP_NUM_THREADS=1

# said STATUS NAME WORDS COMMAND ARGUMENTS...: exit status, one message, words in it; standard error is in said.err
said() {
  local status=$1 name=$2 words=$3 code
  shift 3
  "$granhom" "$@" >said.out 2>said.err
  code=$?
  if [ $code = "$status" ] && grep -qF -- "$words" said.err && [ "$(grep -c '^granhom' said.err)" = "$((status > 0))" ]; then ok "$name"
  else not_ok "$name" "exit $code, wanted $status, and: $words" "$(head -n 5 said.err)"; fi
}
warnings() { grep -c '^warning: ' said.err; }
rows() { wc -l <"$1"; }

# --- accepted states of one packing ---
isotropic() { echo step,F11,F12,F21,F22; k=0; for f in "$@"; do echo "$k,$f,0,0,$f"; k=$((k + 1)); done; }
isotropic 1 0.99 0.96 0.94 0.93 >warned.csv # 0.8537 grains in the cell, and 0.9871 at last
isotropic 1 0.96 0.93 0.9 0.88 >deep.csv    # 1.0370 in step 3 and 1.0847 in step 4
for engine in native lammps; do
  said 0 "$engine: a mean overlap above 0.05 is computed" 'mean overlap' rve "$p" --path warned.csv --engine $engine --normal-stiffness 50 -o w.csv
  check "$engine: and warned of once, with the cause" test "$(warnings)" = 1 -a "$(grep -c 'above 0.05.*of the normal stiffness 50.*units' said.err)" = 1
  said 1 "$engine: a volume fraction above 1 stops" 'step 4: the packing: the volume fraction is 1.085' rve "$p" --path deep.csv --engine $engine --normal-stiffness 50 -o d.csv
  check "$engine: the rows before are on disk" test "$(rows d.csv)" = 5
  said 0 "$engine: --allow-overlap continues" '' rve "$p" --path deep.csv --engine $engine --normal-stiffness 50 --allow-overlap -o a.csv
  check "$engine: all rows, without a warning" test "$(rows a.csv)" = 6 -a "$(warnings)" = 0
  check "$engine: rows of both are the same" sh -c "cut -d, -f1-17 a.csv | head -n 5 >a4; cut -d, -f1-17 d.csv | cmp - a4"
done
for boundary in taylor taylor-cell restricted; do
  said 1 "$boundary: a volume fraction above 1 stops" 'above the limit' rve "$p" --path deep.csv --engine native --boundary $boundary -o d.csv
done
said 1 'allow-overlap with a number stops above it' ', above the limit 0.03, ' rve "$p" --path warned.csv --engine native --allow-overlap 0.03 -o d.csv
said 0 'and continues below it' '' rve "$p" --path warned.csv --engine native --allow-overlap=0.25 -o d.csv
check 'without a warning' test "$(warnings)" = 0
refused_by rve 'an allowed overlap that is negative' '--allow-overlap must be' "$p" --path ../warned.csv --allow-overlap=-1 -o out.csv
said 0 'rve names the stiffness when it is the default' 'normal stiffness 1 (default' rve "$p" --path - --engine native -o d.csv <warned.csv
said 0 'and not when it is given' '' rve "$p" --path warned.csv --engine native --normal-stiffness 1 -o d.csv
check 'not a word about it' test "$(grep -c default said.err)" = 0

# --- studies ---
study() { # STRETCH
  cat >study.yaml <<S
title: limits
rve:
  packing: $p
  contact: {normal_stiffness: 50}
  micro: {boundary: taylor, engine: native}
  path: {legs: [{to: [$1, 0, 0, $1], increments: 10}]}
vary: {micro.tolerance: [1e-3]}
reference: {set: {micro.tolerance: 1e-8}}
S
}
study 0.94
said 0 'a study warns of overlaps of its runs' 'beyond known limits: the packing: the mean overlap is ' study study.yaml -o w
study 0.99
said 0 'a study below them' '' study study.yaml -o n
check 'a study below them: no warning' test "$(warnings)" = 0
study 0.8
said 1 'a study none of whose runs has a right result' 'the volume fraction is ' study study.yaml -o s

# --- deformations that no packing follows ---
path() { printf 'step,F11,F12,F21,F22\n%s\n' "$1" >path.csv; }
unfollowed() { # NAME ROW WORDS
  path "$2"
  refused_by rve "$1" 'path.csv:2: ' "$p" --path ../path.csv -o out.csv
  refused_by rve "$1, with the cause" "$3" "$p" --path ../path.csv -o out.csv
  refused_by crosscheck "$1, crosscheck" "$3" "$p" --path ../path.csv -o out
}
unfollowed 'displacement gradients of zero' 0,0,0,0,0 'F = 1 is undeformed'
unfollowed 'small displacement gradients' 0,-0.01,0,0,-0.02 'displacement gradients'
unfollowed 'a strain in percent' 0,-3,0,0,1 'strains in percent'
unfollowed 'stretches in percent' 0,97,0,0,100 'above the limit 100'
unfollowed 'a compression to two thirds' 0,0.66,0,0,0.66 'the grains would fill'
path 0,1.5,0,0,1.5
said 0 'an expansion beyond contact is no nonsense' '' rve "$p" --path path.csv --engine native -o d.csv

# --- stresses of an element test ---
control() { printf 'steps:\n  - {name: a, increments: 2, control: {%s}}\n' "$1" >control.yaml; }
element() { # NAME CONTROL WORDS
  control "$2"
  refused_by element "$1" 'control.yaml:2: ' "$p" --control ../control.yaml --normal-stiffness 50 -o out.csv
  refused_by element "$1, with the cause" "$3" "$p" --control ../control.yaml --normal-stiffness 50 -o out.csv
}
element 'stresses given as pressures' 's11: 0.2, s22: 0.2, s12: 0' 'tension'
element 'a negative pressure' 'pressure: -0.2, s11 - s22: 0, s12: 0' 'tension'
element 'a Piola stress that pulls' 'P11: 0.1, F22: 1, F12: 0' 'tension'
element 'a sum of tensions' 's11 + s22: 0.4, s11 - s22: 0, s12: 0' 'tension'
element 'stresses in kPa' 's11: -200, s22: -200, s12: 0' 'of the normal stiffness 50, above the limit 0.5'
element 'a shear stress in kPa' 's11: -0.2, s22: -0.2, s12: 50' 'of the normal stiffness 50'
element 'a strain in percent' 'F22: {by: -3}, s11: -0.2, s12: 0' 'strains in percent'
element 'a strain in place of a stretch' 'F22: -0.03, s11: -0.2, s12: 0' 'F = 1 is undeformed'
element 'a volume strain' 'volume: -0.01, s11 - s22: 0, s12: 0' 'F = 1 is undeformed'
printf 'steps:\n  - {name: a, increments: 2, control: {s11: -0.2, s22: -0.2, s12: 0}}\n  - {name: b, increments: 2, control: {s11: {by: 0.4}, s22: hold, s12: 0}}\n' >control.yaml
refused_by element 'a tension by a difference' 'control.yaml:3: ' "$p" --control ../control.yaml --normal-stiffness 50 -o out.csv
printf 's11,s22,s12\n-0.1,-0.1,0\n0.1,-0.1,0\n' >table.csv
refused_by element 'a tension in a table' 'table.csv:3: ' "$p" --path ../table.csv --normal-stiffness 50 -o out.csv
control 's11: -3, s22: -3, s12: 0'
said 0 'a stress above 0.05 of the stiffness is computed' 'is 0.06 of the normal stiffness 50' element "$dense" --control control.yaml --normal-stiffness 50 --engine native -o e.csv
control 's11: {by: 0}, s22: {by: 0}, s12: 0'
said 0 'element names the stiffness when it is the default' 'normal stiffness 1 (default' element "$dense" --control control.yaml --engine native -o e.csv
printf 'steps:\n  - {name: a, increments: 3, control: {F11: {by: -0.13}, F22: {by: -0.13}, F12: 0}}\n' >control.yaml
said 1 'element stops at a state beyond the limits' 'a, increment ' element "$p" --control control.yaml --normal-stiffness 50 --engine native -o e.csv
check 'its rows before are on disk' test "$(rows e.csv)" -ge 2

# --- packings in other units than their cell ---
atoms() { awk -v CONVFMT=%.17g "/^Atoms/ { inside = 1 } inside && NF >= 7 { $1 } { print }" "$p"; } # of p, changed by awk
cell() { awk -v CONVFMT=%.17g -v by="$1" '/[xy]lo [xy]hi/ { $1 *= by; $2 *= by } { print }' "$p"; }
isotropic 1 0.99 >path.csv
controlled='s11: -0.1, s22: -0.1, s12: 0'
read_of() { # PACKING: a scene and a study of it
  printf 'packing: %s\ncontact: {normal_stiffness: 50}\nmesh: {rectangle: {size: [1, 1], elements: [1, 1]}}\n' "$1" >u.yaml
  printf 'start: {confinement: 0.01}\nsupports: [{edge: left, fix: x}, {edge: bottom, fix: y}]\nsteps: [{increments: 1, displace: [{edge: top, y: -0.01}]}]\n' >>u.yaml
  printf 'rve: {packing: %s, contact: {normal_stiffness: 50}, path: {legs: [{to: [0.99, 0, 0, 0.99], increments: 2}]}}\n' "$1" >us.yaml
  printf 'vary: {micro.tolerance: [1e-3]}\nreference: {set: {micro.tolerance: 1e-8}}\n' >>us.yaml
  control "$controlled"
}
misread() { # NAME FILE WORDS: all commands refuse the packing in FILE
  read_of "$2"
  for words in "$2: the grains fill" "$3"; do
    refused_by rve "$1, rve" "$words" "../$2" --path ../path.csv -o out.csv
    refused_by crosscheck "$1, crosscheck" "$words" "../$2" --path ../path.csv -o out
    refused_by element "$1, element" "$words" "../$2" --control ../control.yaml --normal-stiffness 50 -o out.csv
    refused_by run "$1, run" "$words" ../u.yaml -o out
    refused_by run "$1, run --explain" "$words" ../u.yaml --explain
    refused_by study "$1, study" "$words" ../us.yaml -o out
  done
}
atoms '$3 *= 1e-3' >um.data
misread 'diameters in m, cell in mm' um.data 'fill 8.4e-07 of the cell, below the limit 0.01: the likely cause is units'
atoms '$3 /= 10' >cm.data
misread 'diameters in cm, cell in mm' cm.data 'fill 0.0084 of the cell, below the limit 0.01'
cell 1000 >wide.data
misread 'a cell in um, grains in mm' wide.data 'fill 8.4e-07 of the cell, below the limit 0.01'
cell 1e-6 >narrow.data
misread 'a cell in km, grains in mm' narrow.data 'times, at most 20 is possible; the likely cause is units'
atoms '$3 *= 2' >twice.data
misread 'diameters of diameters' twice.data 'fill 3.36 of the cell, above the limit 1.5: the likely cause is units'
atoms '$3 /= 2' >half.data
said 0 'radii for diameters are warned of' 'half.data: the grains fill 0.21 of the cell, and none touch' rve half.data --path path.csv --engine native -o h.csv
atoms '$5 *= 1e-3; $6 *= 1e-3' >heap.data
said 0 'positions in m, cell in mm are warned of' 'heap.data: of 11175 contacts as read 11175 have an overlap above the smaller radius' rve heap.data --path path.csv --engine native -o h.csv
read_of "$p"
said 0 'the packing itself is not' '' rve "$p" --path path.csv --engine native -o h.csv
check 'no warning' test "$(warnings)" = 0
isotropic 1 0.9 0.8 >close.csv
said 0 'a path that closes the gaps is followed' 'none touch' rve cm.data --path close.csv --engine native -o h.csv
# a few grains that touch may be alone, but not where LAMMPS has no room for it
printf 'two\n\n2 atoms\n1 atom types\n\n0 1 xlo xhi\n0 1 ylo yhi\n-0.5 0.5 zlo zhi\n\nAtoms # sphere\n\n1 1 1e-4 1 0.5 0.5 0\n2 1 1e-4 1 0.50009 0.5 0\n' >two.data
said 0 'two grains that touch in a large cell' '' rve two.data --path path.csv --boundary taylor-cell --engine native -o h.csv
if "$granhom" --version | grep -q '^LAMMPS [0-9]'; then
  refused_by rve 'a cell too large for LAMMPS' 'two.data: step 0: the cell of 1 by 1 is too large for LAMMPS with grains of diameter 0.0001: both must be in the same unit' ../two.data --path ../path.csv --boundary taylor-cell -o out.csv
  refused_by element 'a cell too large for LAMMPS, element' 'two.data: the cell of 1 by 1 is too large for LAMMPS' ../two.data --control ../control.yaml -o out.csv
fi

# --- pressures of a packing ---
soft() { said "$1" "$2" "$3" pack --sieve "$root/scenes/block/sieve150.csv" --finish "pressure=$4" --normal-stiffness 50 -o soft.data; }
soft 0 'pack: a pressure above 0.05 of the stiffness is warned of' 'the pressure, 3, is 0.06 of the normal stiffness 50' 3
check 'pack: once' test "$(warnings)" = 1
soft 0 'pack: a pressure below it is not' '' 2
check 'pack: no warning' test "$(warnings)" = 0
refused_by pack 'a pressure in kPa' 'the pressure must lie between 0 and 25, not 200' --sieve "$root/scenes/block/sieve150.csv" --finish pressure=200 --normal-stiffness 50 -o out.data

# --- scenes ---
scene() { # CONTACT START PRESSURE STEPS...
  cat >s.yaml <<S
packing: $p
contact: {normal_stiffness: $1}
micro: {boundary: ${boundary:-taylor}, engine: native}
start: $2
mesh: {rectangle: {size: [100, 100], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - name: a
    increments: ${increments:-2}
    $3
S
}
wrong() { refused_by run "$1" "$2" ../s.yaml -o out; }
scene 50 '{confinement: 0.01}' 'pressure: [{edge: right, to: 200}, {edge: top, to: 200}]'; wrong 'a pressure in kPa' 's.yaml:10: '
wrong 'with the ratio and the cause' 'is 4 of the normal stiffness 50, above the limit 0.5: grains would be squeezed flat; the likely cause is units'
scene 0.05 '{confinement: 0.01}' 'pressure: [{edge: right, to: 0.2}, {edge: top, to: 0.01}]'; wrong 'a stiffness in MPa' 'is 4 of the normal stiffness 0.05'
scene 50 '{confinement: 100}' 'displace: [{edge: top, y: -1}]'; wrong 'a confinement in kPa' 's.yaml:4: the confinement, 100, is 2 of'
scene 50 '{confinement: 0.01}' 'pressure: [{edge: right, to: -0.2}, {edge: top, to: 0.01}]'; wrong 'a pressure that pulls' 'is a tension of 0.2'
scene 50 '{confinement: 0.01}' 'pressure: [{edge: right, from: -0.1, to: 0.2}, {edge: top, to: 0.01}]'; wrong 'a pressure that pulls at first' 'is a tension of 0.1'
scene 50 '{confinement: 0.01}' 'pressure: [{edge: right, to: 0.02}]'; wrong 'a free edge that nothing presses on' "'top', is neither supported nor pressed"
scene 50 '{confinement: 0.01}' 'displace: [{edge: top, y: -300}]'; wrong 'a displacement through the body' 's.yaml:10: this displacement of '\''top'\'' makes the distance to '\''bottom'\'' in y -2 times what it is: the mesh would be turned inside out'
scene 50 '{confinement: 0.01}' 'displace: [{edge: top, y: 30000}]'; wrong 'a displacement far off' 's.yaml:10: this displacement of '\''top'\'' makes the distance to '\''bottom'\'' in y 301 times what it is: no grains would touch'
scene 50 '{confinement: 0.01}' 'displace: [{edge: top, y: -95}]'; wrong 'a displacement that leaves next to nothing' 'no packing can follow'
scene 50 '{confinement: 0.01}' 'displace: [{edge: bottom, y: 130}, {edge: top, y: 0}]'; wrong 'a displacement from below' 'turned inside out'
scene '50, allow_overlap: some' '{confinement: 0.01}' 'displace: [{edge: top, y: -1}]'; wrong 'an allowed overlap that is a word' 'must be true, false or a mean overlap'
scene 50 '{confinement: 0.01}' 'gravity: [0, -2.5e4]'
said 0 'a weight in other units is warned of' 'over the height 100 of the mesh' run s.yaml --explain
scene 50 '{confinement: 0.01}' 'pressure: [{edge: right, to: 4}, {edge: top, to: 4}]'
said 0 'a pressure above 0.05 of the stiffness is warned of when it is read' 'is 0.08 of the normal stiffness 50, above 0.05' run s.yaml --explain
check 'once' test "$(warnings)" = 1
increments=8
scene 50 '{confinement: 0.01}' 'pressure: [{edge: right, to: 16}, {edge: top, to: 16}]'
said 1 'a scene stops at a state beyond the limits' "step 'a', increment 3 of 8: integration point 0: the volume fraction" run s.yaml -o r1
grep '^granhom' said.err >message1
h5= && has HDF5 'places for states, reports' && h5=1
check 'what was complete before is on disk' test "$(rows r1/history.csv)" = 4 -a "(" -z "$h5" -o -s r1/checkpoint.h5 ")"
check 'run.json has the reason' grep -q 'beyond known limits' r1/run.json
if has MPI 'two ranks' && command -v mpirun >/dev/null; then
  mpirun -n 2 "$granhom" run s.yaml --no-share -o r2 >said.out 2>said.err
  grep '^granhom' said.err >message2
  check 'two ranks without sharing: the same message' cmp message1 message2
fi
scene '50, allow_overlap: true' '{confinement: 0.01}' 'pressure: [{edge: right, to: 16}, {edge: top, to: 16}]'
said 0 'allow_overlap: true continues' '' run s.yaml -o r3

# --- places that cannot be written to ---
: >file
mkdir taken
unwritable() { # STATUS NAME PLACE WORDS
  said "$1" "rve: $2" "$4" rve "$p" --path warned.csv --engine native -o "$3"
  for option in tangent dump ${h5:+save-state}; do
    said "$1" "rve --$option: $2" "$4" rve "$p" --path warned.csv --engine native -o kept.csv --$option "$3"
    check "rve --$option: $2: nothing written" test ! -e kept.csv
  done
  control 's11: -0.1, s22: -0.1, s12: 0'
  said "$1" "element: $2" "$4" element "$dense" --control control.yaml --normal-stiffness 50 -o "$3"
  [ -z "$h5" ] || said "$1" "element --save-state: $2" "$4" element "$dense" --control control.yaml --normal-stiffness 50 -o kept.csv --save-state "$3"
  said "$1" "pack: $2" "$4" pack --sieve "$root/scenes/block/sieve150.csv" --seconds 100 -o "$3"
}
unwritable 1 'below a file' file/out file
unwritable 1 'a folder that is missing' nowhere/out nowhere
unwritable 1 'a folder in its place' taken taken
unwritable 1 'a full device' /dev/full '/dev/full'
unwritable 1 'no place for files' /proc/out '/proc'
scene 50 '{confinement: 0.01}' 'displace: [{edge: top, y: -0.1}]'
said 1 'run: no place for files' '/proc' run s.yaml -o /proc/out
check 'run: before the start is solved' test "$(grep -c iteration said.err)" = 0
mkdir -p half/history.csv half2 && : >half2/dumps
said 2 'run: a folder in the place of a table' 'history.csv' run s.yaml -o half
said 2 'run: a file in the place of a folder' 'dumps' run s.yaml -o half2
said 1 'crosscheck: no place for files' '/proc' crosscheck "$p" --path warned.csv --engines native,lammps -o /proc/out
[ -z "$h5" ] || said 1 'report: below a file' 'file' report r3 -o file/out
said 1 'plot: no place for files' '/proc' plot r3 -o /proc/out
check 'nothing is left behind' test -z "$(find . -name '.granhom-*')"
exit $bad
