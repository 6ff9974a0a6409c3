#!/usr/bin/env bash
# `granhom crosscheck` as users run it: table, files, refinement, programs that are missing, fail or hang, bad input.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, check
begin
packing=$root/tests/data/cases/packings/p50d.data
cross() { "$granhom" crosscheck "$packing" --normal-stiffness 1000 --tolerance 1e-10 "$@"; }
# column FILE NAME: the values of a column
column() { awk -F, -v name="$2" 'NR == 1 { for (c = 1; c <= NF; c++) if ($c == name) at = c; if (!at) exit 1; next } { print $at }' "$1"; }
# worst FILE NAME...: the largest size of any value in these columns
worst() {
  local file=$1 name
  shift
  for name in "$@"; do column "$file" "$name"; done | awk '{ v = $1 < 0 ? -$1 : $1; if (v > w) w = v; n++ } END { if (!n) exit 1; printf "%.3g\n", w }'
}
below() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a + 0 < b + 0) }'; }

printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.9995,0,0,1\n2,0.999,0,0,1\n3,0.9985,0,0,1\n' >path.csv
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n5,0.9995,0.0004,0.0002,1.0001\n' >shear.csv
liggghts=
command -v liggghts >/dev/null && liggghts=yes

# --- without friction: the same equilibrium everywhere ---
cross --path path.csv -o plain >table 2>said
check "all programs: exit 0" test $? = 0
check "the table has a line for each" test "$(grep -c -e '^granhom on LAMMPS' -e '^granhom native' -e '^LAMMPS gran/hooke/history' -e '^LIGGGHTS hooke/stiffness' table)" -ge 4
check "the first is the reference" grep -Eq '^granhom on LAMMPS +done .* reference' table
check "a row per increment" test "$(wc -l <plain/crosscheck.csv)" = 5
check "the native engine agrees" below "$(worst plain/crosscheck.csv native_d11 native_d22 native_d12)" 1e-9
check "gran/hooke/history agrees to what the residual leaves" below "$(worst plain/crosscheck.csv gran_d11 gran_d22 gran_d12)" 1e-7
if [ $liggghts ]; then
  check "LIGGGHTS agrees to what the residual leaves" below "$(worst plain/crosscheck.csv liggghts_d11 liggghts_d22 liggghts_d12)" 1e-7
else
  echo "skip - no liggghts"
  check "LIGGGHTS is reported as missing" grep -Eq '^LIGGGHTS hooke/stiffness +missing +- ' table
fi
cross --path path.csv --engines native,lammps --quiet -o quiet >quiet.out 2>&1
check "--quiet: results, and not a word" test $? = 0 -a ! -s quiet.out -a -s quiet/crosscheck.csv
check "residuals are met" below "$(worst plain/crosscheck.csv lammps_residual native_residual gran_residual)" 1.0000001e-10
"$granhom" rve "$packing" --engine native --normal-stiffness 1000 --tolerance 1e-10 --path path.csv -o rve.csv 2>/dev/null
check "the stresses are those of granhom rve" diff <(column plain/crosscheck.csv native_s11) <(column rve.csv s11)
if command -v gnuplot >/dev/null; then check "a picture" sh -c 'head -c 4 plain/crosscheck.png | grep -q PNG'; else echo "skip - no gnuplot"; fi
check "no refinement, no file of it" test ! -e plain/refine.csv

# --- friction ---
cross --path - <path.csv -o mu --engines native,gran --friction-coefficient 0.5 --tangential-stiffness 200 --refine 3 >table 2>said
check "friction, path from standard input: exit 0" test $? = 0
difference=$(worst mu/crosscheck.csv gran_d11 gran_d22 gran_d12)
check "within half a percent" below "$difference" 5e-3
check "and not the same" below 1e-8 "$difference"
check "a line for each number of parts" test "$(column mu/refine.csv parts | tr '\n' ' ')" = "1 2 4 "
check "the first line is the path as given" test "$(printf '%.1e' "$(column mu/refine.csv gran_difference | sed -n 1p)")" = "$(printf '%.1e' "$difference")"
check "both change by less with smaller increments" awk -F, 'NR == 1 { for (c = 1; c <= NF; c++) at[$c] = c; next }
  NR == 3 { n = $at["native_change"]; g = $at["gran_change"] } NR == 4 { exit !($at["native_change"] < 0.7 * n && $at["gran_change"] < 0.7 * g && $at["gran_change"] > 0) }' mu/refine.csv
check "the orders are reported" grep -q '^Change of each from half as many substeps' table

# --- shear and rotation: LIGGGHTS cannot, and that is no agreement ---
cross --path shear.csv -o shear --liggghts /bin/true >table 2>said
check "shear: exit 0" test $? = 0
check "LIGGGHTS is unable to shear" grep -Eq '^LIGGGHTS hooke/stiffness +unable +- ' table
check "why" grep -q '^LIGGGHTS hooke/stiffness: unable: row 1: the cell is tilted' table
check "its columns are empty" test -z "$(column shear/crosscheck.csv liggghts_s11 | tr -d '\n')$(column shear/crosscheck.csv liggghts_d11 | tr -d '\n')"
check "gran/hooke/history follows a cell that turns" below "$(worst shear/crosscheck.csv gran_d11 gran_d22 gran_d12)" 1e-7
check "steps are those of the path" test "$(column shear/crosscheck.csv step | tr '\n' ' ')" = "0 5 "

# --- a missing program, one that fails, one that hangs ---
cross --path path.csv -o missing --engines native,liggghts --liggghts no-such-program >table 2>said
check "missing: exit 0" test $? = 0
check "missing: said so" grep -Eq '^LIGGGHTS hooke/stiffness +missing +- ' table
check "missing: no difference" test -z "$(column missing/crosscheck.csv liggghts_d11 | tr -d '\n')"
printf '#!/bin/sh\necho "ERROR: Illegal command"\nexit 1\n' >broken && chmod +x broken
cross --path path.csv -o failed --engines native,liggghts --liggghts ./broken >table 2>said
check "failed: exit 1" test $? = 1
check "failed: with its last message" grep -q 'failed: .*status 1: ERROR: Illegal command' table
check "failed: the rest is written" test "$(column failed/crosscheck.csv native_s11 | grep -c .)" = 4
printf '#!/bin/sh\nsleep 100\n' >hang && chmod +x hang
cross --path path.csv -o hung --engines native,liggghts --liggghts ./hang --time-limit 0.5 >table 2>said
check "hangs: exit 1" test $? = 1
check "hangs: stopped" grep -Eq '^LIGGGHTS hooke/stiffness +stopped ' table
cross --path path.csv -o short --engines native,gran --max-steps 20 >table 2>said
check "too few steps: exit 1" test $? = 1
check "too few steps: rows that were reached are kept" test "$(column short/crosscheck.csv gran_s11 | grep -c .)" = 1

# --- bad input: exit 2, one message, nothing written ---
refused() { refused_by crosscheck "$@"; }
p=$packing
o="--path ../path.csv -o out"
# shellcheck disable=SC2086
{
  refused "no packing" "which packing?" $o
  refused "two packings" "one packing at a time" $p $p $o
  refused "no path" "--path is missing" $p -o out
  refused "no folder" "-o is missing" $p --path ../path.csv
  refused "unknown option" "unknown option --engine-list" $p $o --engine-list native
  refused "option without value" "--refine needs a value" $p $o --refine
  refused "unknown relaxation" '--relaxation must be polished, damped or fire, not ""' $p $o --relaxation ""
  refused "unknown engine" 'not "yade"' $p $o --engines lammps,yade
  refused "empty engine" 'not ""' $p $o --engines lammps,
  refused "one engine" "two or more" $p $o --engines gran
  refused "an engine twice" "names gran twice" $p $o --engines gran,native,gran
  for value in 0 9 -1 1.5 many; do refused "--refine $value" "--refine must be an integer from 1 to 8, not \"$value\"" $p $o --refine $value; done
  for value in 0 -5 x; do refused "--increment-steps $value" "--increment-steps must be an integer" $p $o --increment-steps $value; done
  for value in 0 -1 nan; do
    refused "--time-limit $value" "--time-limit must be a positive number" $p $o --time-limit $value
    refused "--tolerance $value" "--tolerance must be a positive number" $p $o --tolerance $value
  done
  refused "tolerance 1" "--tolerance must be below 1" $p $o --tolerance 1
  refused "hardening" "--hardening must be 0" $p $o --friction-angle 20 --hardening 10
  refused "friction without a number" "--friction-coefficient must be" $p $o --friction-coefficient much
  for boundary in taylor taylor-cell restricted; do
    refused "boundary $boundary" "--boundary can only be periodic" $p $o --boundary $boundary
  done
  refused "missing packing" "none.data: " none.data $o
  refused "missing path" "none.csv: " $p --path none.csv -o out
  printf 'step,F11,F12,F21,F22\n0,1,0.7,0,1\n' >wide.csv
  refused "too much shear" "sheared by 0.7 of its width" $p --path ../wide.csv -o out
  printf 'step,F11,F12,F21,F22\n0,1,0,0,-1\n' >turned.csv
  refused "det F < 0" "turned.csv:2: " $p --path ../turned.csv -o out
  sed -e 's/^50 atoms/1 atoms/' -e '/^[2-9] 1 /d' -e '/^[1-5][0-9] 1 /d' -e 's/-0.436[0-9]* 0.436[0-9]*/-0.1 0.1/' "$p" >tiny.data
  refused "a cell of one grain" "the programs to compare with need twice the largest diameter" ../tiny.data $o
}
check "help lists the options" sh -c "'$granhom' help crosscheck | grep -q -- --increment-steps"
exit $bad
