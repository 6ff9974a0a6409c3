#!/usr/bin/env bash
# `granhom pack` as users run it: hard and soft packings, fabric, ensembles, pictures, bad input.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # ok, not_ok, check
BUILD=$(cd "${BUILD:-build}" && pwd) || exit 1
granhom=$BUILD/granhom
work=$(mktemp -d) && cd "$work" || exit 1
trap 'rm -rf "$work"' EXIT
pack() { "$granhom" pack "$@" 2>progress; }
# refuse NAME WORDS ARGUMENTS...: exit status 2, a message with WORDS, no packing
refuse() {
  local name=$1 words=$2
  shift 2
  rm -f never.data
  "$granhom" pack "$@" -o never.data >said 2>&1
  local code=$?
  check "refused: $name" test $code = 2 -a ! -e never.data
  check "  and it states so" grep -q -- "$words" said
}
# number FILE LABEL [N]: the N-th number (1) behind the label of a line
number() { sed -n "s/^$2  *//p" "$1" | tr ' ' '\n' | grep -E '^[-+0-9.]' | tr -d , | sed -n "${3:-1}p"; }
plus() { awk -v a="$1" -v b="$2" 'BEGIN { print a + b }'; }
# between LOW VALUE HIGH
between() { awk -v a="$1" -v x="$2" -v b="$3" 'BEGIN { exit !(x != "" && x >= a && x <= b) }'; }

cat >sieve.csv <<'END'
diameter,count
0.100,14
0.125,30
0.160,16
END

# --- hard packings ---
pack --sieve sieve.csv --seed 3 -o hard.data >said
check "a sieve curve gives a packing" test $? = 0 -a -s hard.data
"$granhom" pack --sieve sieve.csv --seed 3 --quiet -o quiet.data >quiet 2>&1
check "--quiet: the same packing, and not a word" test $? = 0 -a ! -s quiet -a -z "$(diff hard.data quiet.data)"
check "it states how dense it is" between 0.8 "$(number said 'volume fraction')" 0.92
check "it states that its hull is full, or not" grep -Eq '^boundary grains  *[0-9]+ of 60, (not )?full: widest gap' said
check "types are fractions, finest first, with their diameters" awk '
  /^Atoms/ { on = 1; next } on && NF { n[$2]++; d[$2] = $3 } END {
  exit !(n[1] == 14 && n[2] == 30 && n[3] == 16 && d[1] + 0 == 0.1 && d[2] + 0 == 0.125 && d[3] + 0 == 0.16) }' hard.data
pack --sieve sieve.csv --seed 3 -o again.data >/dev/null
check "the same seed gives the same packing" cmp hard.data again.data
pack --sieve sieve.csv --seed 4 -o other.data >/dev/null
check "another seed gives another" test -s other.data
check "  that differs" bash -c '! cmp -s hard.data other.data'
check "no two disks overlap" awk '
  / xlo / { L = $2 - $1 } / ylo / { H = $2 - $1 } / xy / { xy = $1 } /^Atoms/ { on = 1; next }
  on && NF { n++; x[n] = $5; y[n] = $6; r[n] = $3 / 2 }
  END { for (i = 1; i <= n; i++) for (j = i + 1; j <= n; j++) for (a = -1; a <= 1; a++) for (b = -1; b <= 1; b++) {
    dx = x[j] - x[i] + a * L + b * xy; dy = y[j] - y[i] + b * H
    if (sqrt(dx * dx + dy * dy) < (r[i] + r[j]) * (1 - 1e-12)) exit 1 } exit !(n == 60) }' hard.data

# --- soft packings ---
pack --sieve sieve.csv --seed 3 --finish overlap=0.01 -o soft.data >said
check "a mean overlap" between 0.0099 "$(number said 'mean overlap')" 0.0101
check "  in equilibrium" between 0 "$(number said residual)" 1e-10
check "  with its coordination number" between 3.5 "$(number said 'coordination number')" 6
pack --sieve sieve.csv --seed 3 --finish pressure=0.1 --normal-stiffness 50 -o soft.data >said
check "a pressure" between 0.099 "$(number said pressure)" 0.101
check "  the same in all directions" awk '/^Cauchy stress/ {
  exit !($4 < -0.099 && $4 > -0.101 && $6 < -0.099 && $6 > -0.101 && $8 * $8 < 1e-6) } ' said
check "  in a stable packing" between 0 "$(number said 'smallest acoustic')" 1000
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n' >path.csv
"$granhom" rve soft.data --path path.csv --engine native --normal-stiffness 50 -o rve.csv 2>/dev/null
check "granhom rve reads it and finds the same stress" awk -F, '
  NR == 2 { exit !($10 < -0.099 && $10 > -0.101 && $13 < -0.099 && $13 > -0.101) }' rve.csv
for wanted in 0.02 0.05 0.08; do
  pack --sieve sieve.csv --seed 3 --finish overlap=0.003 --anisotropy $wanted -o fabric.data >said
  check "a fabric anisotropy of $wanted" between "$(plus $wanted -0.005)" "$(number said 'fabric anisotropy')" "$(plus $wanted 0.005)"
  check "  with the mean overlap" between 0.00297 "$(number said 'mean overlap')" 0.00303
done

# --- ensembles, pictures ---
pack --sieve sieve.csv --seed 3 --ensemble 3 -o member.data --picture member.svg >said
check "an ensemble of three" test -s member-001.data -a -s member-002.data -a -s member-003.data -a ! -e member.data
check "  from seeds in sequence" cmp hard.data member-001.data
check "  and the next" cmp other.data member-002.data
check "  each with its picture" test -s member-001.svg -a -s member-003.svg
pack --sieve sieve.csv --seed 3 -o hard.data --picture hard.png >/dev/null
check "a picture as PNG" test "$(head -c 4 hard.png | tail -c 3)" = PNG
pack --sieve sieve.csv --dimension 3 --volume-fraction 0.5 -o spheres.data --picture spheres.png >said
pack --sieve sieve.csv --seed 3 -o hard.data --picture hard.svg >said
check "a picture as SVG" /usr/bin/python3 -c 'import xml.dom.minidom as m; assert m.parse("hard.svg").documentElement.tagName == "svg"'
check "  with each boundary grain in red" /usr/bin/python3 -c '
import re
red = len(re.findall(r"fill(:|=.)rgb\(84%, ?38%, ?28%\)", open("hard.svg").read())) # cairo writes a style or an attribute
said = re.search(r"^boundary grains +(\d+)", open("said").read(), re.M)
assert red == int(said[1]), (red, said[1])'
check "spheres, with a picture" test $? = 0 -a -s spheres.data -a -s spheres.png

# --- bad input ---
refuse "an unknown way to finish" "overlap=X or pressure=P" --sieve sieve.csv --finish density=1
refuse "a negative overlap" "no positive number" --sieve sieve.csv --finish overlap=-0.1
refuse "an anisotropy without a finish" "--finish" --sieve sieve.csv --anisotropy 0.05
refuse "spheres to be finished" "two dimensions" --sieve sieve.csv --dimension 3 --finish overlap=0.01
refuse "a picture of another kind" ".svg" --sieve sieve.csv --picture a.jpg
refuse "a missing sieve curve" "nowhere.csv" --sieve nowhere.csv
refuse "a pressure that would squeeze the grains flat" "pressure" --sieve sieve.csv --finish pressure=3
pack --sieve sieve.csv --finish overlap=0.02 --anisotropy 0.9 -o never.data >said
check "an anisotropy that no packing has ends with exit status 1" test $? = 1 -a ! -e never.data
check "  and names the nearest" grep -q "the nearest is 0\." progress
exit $bad
