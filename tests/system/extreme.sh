#!/usr/bin/env bash
# The program at the edges: exit status and message of what is refused, numbers of what is answered. Rows of docs/reports/stability.md go to
# the file GH_EXTREME_TABLE, where that is set. SPDX-License-Identifier: GPL-2.0-or-later
set -u
BUILD=$(cd "${BUILD:-build}" && pwd) || exit 1
root=$(pwd)
granhom=$BUILD/granhom
packings=$root/tests/data/cases/packings
work=$(mktemp -d) && cd "$work" || exit 1
trap 'rm -rf "$work"' EXIT
bad=0

row() { [ -z "${GH_EXTREME_TABLE:-}" ] || printf '%s|%s|%s|%s\n' "$@" >>"$GH_EXTREME_TABLE"; }
# No value in the files written so far is other than finite.
finite() { ! grep -qiE '(^|,)-?(nan|inf)' "$@"; }
# verdict NAME STATUS WANTED WORDS FILE...: exit status and message are as wanted, files hold numbers; adds the row
verdict() {
  local name=$1 status=$2 wanted=$3 words=$4 good=1 outcome
  shift 4
  [ "$status" = "$wanted" ] || good=0
  [ -z "$words" ] || grep -qE "^granhom( rve| run)?: .*$words" log || good=0
  for file in "$@"; do { [ -s "$file" ] && finite "$file"; } || good=0; done
  if [ $good = 1 ]; then echo "ok - $name"; else
    echo "not ok - $name"
    echo "  status $status, wanted $wanted and \"$words\""
    tail -n 3 log | sed 's/^/  /'
    bad=1
  fi
  outcome="exit status $status"
  [ -z "$words" ] || outcome="$outcome: $(sed -nE 's/; (residual|largest) .*//; s/^granhom( rve| run)?: //p' log | head -n 1 | tr '|' '/' | cut -c 1-200)"
  row Program "$name" "exit status, message; files hold finite numbers" "$outcome"
}
# rve NAME WANTED WORDS ARGUMENTS...: files are looked at where rows were written
rve() {
  local name=$1 wanted=$2 words=$3 files=()
  shift 3
  rm -f out.csv
  "$granhom" rve "$@" -o out.csv >log 2>&1
  local status=$?
  [ -e out.csv ] && files=(out.csv)
  verdict "rve: $name" $status "$wanted" "$words" "${files[@]}"
}
path() { printf 'F11,F12,F21,F22\n1,0,0,1\n%s\n' "$1" >path.csv; }
# grains NAME LINE...: a packing in a cell of 10 x 10
grains() {
  local name=$1
  shift
  { printf 'grains\n\n%d atoms\n1 atom types\n\n0 10 xlo xhi\n0 10 ylo yhi\n-0.5 0.5 zlo zhi\n\nAtoms # sphere\n\n' $#
    printf '%s\n' "$@"; } >"$name"
}
sand=$packings/p50d.data

path 0.99,0.003,0,0.99
rve "friction angle of 89.9 degrees" 0 "" $sand --path path.csv --friction-angle 89.9
rve "friction angle of 90 degrees" 2 "90" $sand --path path.csv --friction-angle 90
rve "hardening of 1000 E, one increment of 1 %" 0 "" $sand --path path.csv --friction-angle 20 --hardening 1000
rve "negative hardening" 2 "hardening" $sand --path path.csv --friction-angle 20 --hardening -1
rve "stiffness 1e160" 2 "normal stiffness must lie between" $sand --path path.csv --normal-stiffness 1e160
rve "tolerance 1e-30: round-off is not asked for" 0 "" $sand --path path.csv --tolerance 1e-30
path 0.3,0,0,0.3
rve "compression to J = 0.09 at once" 2 "the grains would fill 9.66 of the cell" $sand --path path.csv
rve "compression to J = 0.09 at once, overlaps allowed" 0 "" $sand --path path.csv --allow-overlap
path 0.01,0,0,0.01
rve "compression to J = 1e-4, overlaps allowed" 1 "compressed too far" $sand --path path.csv --allow-overlap
path 1,0,0,0
rve "det F = 0" 2 "path.csv:3: .* has the determinant 0" $sand --path path.csv
path 1e5,0,0,1e5
rve "expansion by 1e5" 2 "is 1e.10, above the limit 100" $sand --path path.csv
path 1e5,0,0,1e-3
rve "a cell of 1e5 by 1e-3 of its size" 1 "is too thin for grains" $sand --path path.csv
path 1,1000,0,1
rve "shear of 1000 at once, frictionless" 0 "" $sand --path path.csv
rve "shear of 1000 at once, with friction" 1 "too long for a ramp" $sand --path path.csv --friction-angle 20 --max-steps 2000
path 0.99,0,0,0.985
grains same.data "1 1 2 1 3 3 0" "2 1 2 1 3 3 0"
rve "two grains at one place" 2 "same.data: grains 1 and 2 are at one place" same.data --path path.csv
grains loose.data "1 1 2 1 3 3 0" "2 1 2 1 7 7 0"
rve "rattlers only" 0 "" loose.data --path path.csv
[ "$(awk -F, 'NR > 1 && ($6 != 0 || $7 != 0 || $8 != 0 || $9 != 0)' out.csv)" = "" ]
verdict "rve: rattlers only: no stress" $? 0 "" out.csv
grains one.data "1 1 10.1 1 3 3 0"
rve "one grain that touches its own images" 0 "" one.data --path path.csv --friction-angle 20

# scene NAME BOUNDARY PRESSURE [PACKING]: a block of 2 x 2 elements under a pressure from the right
scene() {
  cat >"$1.yaml" <<END
packing: ${4:-$root/scenes/block/sand150.data}
contact: {normal_stiffness: 50}
micro: {boundary: $2, engine: native}
start: {confinement: 0.01}
mesh: {rectangle: {size: [100, 100], elements: [2, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: confine, increments: 5, supports: [{edge: top, fix: y}], pressure: [{edge: right, from: 0.01, to: $3}]}
results: {rves: none}
END
}
run() {
  local name=$1 wanted=$2 words=$3 scene=$4 files=()
  "$granhom" run "$scene.yaml" -o "$scene" >log 2>&1
  local status=$?
  [ -d "$scene" ] && files=("$scene/history.csv" "$scene/convergence.csv")
  verdict "run: $name" $status "$wanted" "$words" "${files[@]}"
}
scene low taylor 0.2
run "block under a pressure of 0.004 E, Taylor" 0 "" low
scene high taylor 5000
run "block under a pressure of 100 E, Taylor" 2 "is 100 of the normal stiffness 50, above the limit 0.5" high
allowed() { sed -i 's/^contact: {/&allow_overlap: true, /' "$1.yaml"; }
allowed high
run "block under a pressure of 100 E, Taylor, overlaps allowed" 1 "no equilibrium after" high
if [ "${GH_EXTREME_FULL:-}" = 1 ]; then # a quarter of a minute each
  scene high_restricted restricted 100
  allowed high_restricted
  run "block under a pressure of 2 E, restricted" 1 "no equilibrium after" high_restricted
  scene high_periodic periodic 30
  allowed high_periodic
  run "block under a pressure of 0.6 E, periodic" 1 "no equilibrium after" high_periodic
fi
scene loose taylor 0.2 loose.data
run "block of rattlers only" 1 "unjammed" loose
sed 's/elements: \[2, 2\]}/elements: [2, 2]}, move: [{node: [50, 50], by: [60, 0]}]/' low.yaml >folded.yaml
run "mesh with an element that is turned inside out" 2 "inverted or not convex" folded
sed 's/size: \[100, 100\]/size: [1000, 1]/' low.yaml >slender.yaml
run "elements with sides 1000:1" 0 "" slender
exit $bad
