#!/usr/bin/env bash
# `granhom rve` as users run it: files and pipes, tangent, dump, state, bad input, an increment that does not converge.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, check
begin
packing=$root/tests/data/cases/packings/p50.data
rve() { "$granhom" rve "$@"; }
native() { rve "$packing" --engine native --normal-stiffness 1000 "$@"; }
# The columns of a results file that do not hold times.
results() { cut -d, -f1-17,19- "$1"; }

cat >path.csv <<'END'
step,F11,F12,F21,F22
0,1,0,0,1
1,0.998,0.001,0,0.999
2,0.996,0.002,0,0.998
3,0.994,0.003,0,0.997
END

# --- results ---
columns=step,F11,F12,F21,F22,P11,P12,P21,P22,s11,s12,s21,s22,energy,contacts,rattlers,residual,seconds
native --path path.csv -o out.csv >said 2>&1
check "a path gives a file of results" test $? = 0 -a "$(wc -l <out.csv)" = 5
check "the columns are those of the guide" test "$(head -n 1 out.csv)" = $columns,events,newton
check "nothing goes to standard output beside the file" test -z "$(native --path path.csv -o out.csv 2>/dev/null)"
check "steps and F are repeated as given" test "$(sed -n 3p out.csv | cut -d, -f1-5)" = 1,0.998,0.001,0,0.999
check "numbers have 17 digits, pressure is negative, the residual is met" awk -F, '
  NR > 1 { n++; if ($6 >= 0 || $9 >= 0 || $17 > 1e-8 || length($6) < 17) exit 1 } END { if (n != 4) exit 1 }' out.csv
native --path path.csv >piped.csv 2>/dev/null
check "without -o the same goes to standard output" diff <(results out.csv) <(results piped.csv)
native --path - -o - <path.csv >piped.csv 2>/dev/null
check "path from standard input" diff <(results out.csv) <(results piped.csv)
sed 's/step,//; s/^[0-9],//' path.csv | awk -F, 'BEGIN { OFS = "," } { print $4, $3, $2, $1 }' >swapped.csv
native --path swapped.csv -o swapped_out.csv 2>/dev/null
check "columns of the path are found by name, steps are counted" diff <(results out.csv) <(results swapped_out.csv)
native --friction-angle 20 --path path.csv --max-steps 20 --accept 100 -o taken.csv >said 2>&1
check "--accept accepts a packing unconverged, and reports it" test $? = 0 -a "$(grep -c 'accepted unconverged, with a residual of' said)" = 3
awk 'BEGIN { print "F11,F12,F21,F22"; for (k = 0; k <= 8; k++) printf "%.17g,%.17g,0,1\n", 1 - k / 256, k / 128 }' >halves.csv
awk 'NR == 1 || NR % 2 == 0' halves.csv >wholes.csv
for way in "--tolerance 1e-8" "--friction-angle 20 --max-steps 20 --accept 100"; do
  native $way --path halves.csv -o halves_out.csv 2>/dev/null
  native $way --path wholes.csv --estimate-error -o wholes_out.csv >said 2>&1
  check "the residual is the largest of an increment's substeps ($way)" awk -F, 'FNR == 1 { next } NR == FNR { r[FNR] = $17; next }
    FNR > 2 { n++; a = r[2 * FNR - 3]; b = r[2 * FNR - 2]; first += a > b; if ($17 != (a > b ? a : b)) exit 1 } END { exit !(n == 4 && first) }' halves_out.csv wholes_out.csv
done
check "as in the warning of states accepted unconverged" awk -F, 'NR == FNR { if (sub(/.*step /, "") && sub(/: accepted unconverged, with a residual of /, ",")) { w[$1] = $2; n++ } next }
  FNR > 2 { if (sprintf("%.2g", $17) != w[$1]) exit 1; m++ } END { exit !(n == 4 && m == 4) }' said wholes_out.csv
native --quiet --path path.csv -o quiet.csv >said 2>&1
check "--quiet: the same results, and not a word" test $? = 0 -a ! -s said -a -z "$(diff <(results out.csv) <(results quiet.csv))"
for boundary in taylor taylor-cell restricted periodic; do
  check "boundary $boundary" native --boundary $boundary --path path.csv -o $boundary.csv
done
check "periodic is the default" diff <(results out.csv) <(results periodic.csv)
check "more freedom carries less" awk -F, 'FNR == 5 { e[FILENAME] = $14 } END {
  exit !(e["taylor.csv"] > e["restricted.csv"] && e["restricted.csv"] > e["periodic.csv"] && e["taylor-cell.csv"] > e["periodic.csv"]) }' \
  taylor.csv taylor-cell.csv restricted.csv periodic.csv
awk 'BEGIN { print "F11,F12,F21,F22"; for (k = 1; k <= 240; k++) print "0.97," k / 200 ",0,0.97" }' >far.csv
rve "$root/tests/data/cases/packings/p20.data" --engine native --tangential-stiffness 0.8 --friction-angle 17.5 --tolerance 1e-11 \
  --path far.csv -o far_out.csv >said 2>&1
check "sheared far with friction" test $? = 0
check "where slip has no equilibrium over an increment a ramp leads to one, and is counted" awk -F, '
  NR == 1 { for (k = 1; k <= NF; k++) if ($k == "ramps") c = k } NR > 1 { sum += $c } END { exit !(c && sum > 0) }' far_out.csv
check "to the tolerance" awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "residual") c = k } NR > 1 && !($c <= 1e-11) { exit 1 } END { if (NR != 241) exit 1 }' far_out.csv
native --path path.csv --tolerance 1e-11 -o native.csv 2>/dev/null
rve "$packing" --engine lammps --normal-stiffness 1000 --path path.csv --tolerance 1e-11 -o lammps.csv >said 2>&1
same_stresses() { awk -F, '
  FNR > 1 { for (c = 6; c <= 13; c++) { v = $c; if (NR == FNR) { a[FNR, c] = v; if (v < 0) v = -v; if (v > most) most = v } else { d = v - a[FNR, c]; if (d < 0) d = -d; if (d > worst) worst = d; n++ } } }
  END { exit !(n == 32 && worst <= 1e-9 * most) }' "$1" "$2"; }
check "LAMMPS gives the same stresses" same_stresses native.csv lammps.csv
for way in polished damped fire; do
  native --path path.csv --tolerance 1e-11 --relaxation $way -o $way.csv 2>/dev/null
  check "--relaxation $way gives the same stresses" same_stresses native.csv $way.csv
done
check "polished is the default" diff <(results native.csv) <(results polished.csv)
differ() { ! diff -q <(results "$1") <(results "$2") >/dev/null; }
check "damped is another way" differ polished.csv damped.csv
check "fire is another way" differ damped.csv fire.csv

# --- tangent ---
native --path path.csv -o out.csv --tangent tangent.csv 2>/dev/null
check "the tangent's columns" test "$(head -n 1 tangent.csv)" = \
  step,A1111,A1112,A1121,A1122,A1211,A1212,A1221,A1222,A2111,A2112,A2121,A2122,A2211,A2212,A2221,A2222
check "the tangent has a row per increment and major symmetry" awk -F, 'NR > 1 { n++; if (NF != 17) exit 1
  for (a = 0; a < 4; a++) for (b = 0; b < 4; b++) { d = $(2 + 4 * a + b) - $(2 + 4 * b + a); if (d < 0) d = -d; if (d > 1e-9 * $2) exit 1 } }
  END { if (n != 4) exit 1 }' tangent.csv

# --- dump ---
frames() { # number of frames; fails unless each has as many atoms as it states, 13 words each
  awk '/^ITEM: TIMESTEP/ { if (n && left) exit 1; n++; want = "step"; next }
    want == "step" { if ($1 != n - 1) exit 1; want = ""; next }
    /^ITEM: NUMBER OF ATOMS/ { want = "number"; next }
    want == "number" { left = $1; want = ""; next }
    /^ITEM: BOX BOUNDS/ { want = "box"; lines = 0; next }
    want == "box" && lines < 3 { if (!($1 < $2)) exit 1; lines++; next }
    /^ITEM: ATOMS id type x y z ix iy iz radius/ { want = "atoms"; next }
    want == "atoms" { if (NF != 13 || $9 <= 0 || left-- <= 0) exit 1; next }
    { exit 1 }
    END { if (left) exit 1; print n }' "$1"
}
for boundary in taylor periodic; do
  native --boundary $boundary --path path.csv -o out.csv --dump $boundary.dump 2>/dev/null
  check "the dump of $boundary has a whole frame for each increment" test "$(frames $boundary.dump)" = 4
done
check "a cluster shows its replicas" test "$(sed -n 4p taylor.dump)" = 65
check "a periodic cell is written with its tilt" grep -q '^ITEM: BOX BOUNDS xy xz yz pp pp pp' periodic.dump
printf 'units lj\natom_style sphere\ndimension 2\nboundary p p p\nread_data %s\nchange_box all triclinic\nread_dump periodic.dump 3 x y box yes replace yes format native\nprint "LX $(lx:%%.12g) XY $(xy:%%.12g) N $(atoms)"\n' "$packing" >read.in
if command -v lmp >/dev/null; then
  lmp -in read.in -log none >lmp.out 2>&1
  check "LAMMPS reads the dump" grep -q '^LX 0.875147959309 XY 0.00264129162769 N 50' lmp.out
else
  echo "skip - no lmp to read the dump"
fi

# --- state ---
sed -n '1,3p' path.csv >first.csv
sed -n '1p;4,5p' path.csv >second.csv
states= && has HDF5 "states" && states="taylor periodic"
for boundary in $states; do
  native --boundary $boundary --path path.csv -o whole.csv 2>/dev/null
  native --boundary $boundary --path first.csv -o first_out.csv --save-state state.h5 2>/dev/null
  native --boundary $boundary --path second.csv -o second_out.csv --load-state state.h5 2>/dev/null
  check "$boundary: saved and loaded, a path continues to the last digit" diff <(results whole.csv | sed -n 4,5p) <(results second_out.csv | sed 1d)
done

# --- friction ---
rubbing() { native --friction-angle 20 --hardening 10 "$@"; }
rubbing --path path.csv -o rub.csv --dump rub.dump 2>/dev/null
check "friction adds its columns" test "$(head -n 1 rub.csv)" = "$columns,energy_t,dissipation,sliding,ramps,events,newton"
check "some contacts slide, and dissipate" awk -F, 'END {exit !($21 > 0 && $20 > 0 && $19 > 0)}' rub.csv
# a cell that is sheared and rotated by affine motion: box, image flags and cell give back F X, turned so that the first lattice
# vector lies along x
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n1,1,1.3,0,1\n2,0.8,-1.1,0.6,0.9\n' >far.csv
native --boundary taylor-cell --path far.csv -o far.out --dump far.dump 2>/dev/null
check "positions of a dump follow the grains through the box" awk -v tol=1e-12 '
  function close_to(a, b) { return a - b < tol && b - a < tol }
  BEGIN { F[1] = "1 1.3 0 1"; F[2] = "0.8 -1.1 0.6 0.9" }
  FNR == 1 { file++ }
  file == 1 && NF >= 7 && $1 ~ /^[0-9]+$/ { X[$1] = $5; Y[$1] = $6; next }
  file == 1 { next }
  /^ITEM: TIMESTEP/ { getline step; next }
  /^ITEM: BOX/ { getline a; getline b; split(a, x); split(b, y); xy = x[3]; lx = x[2] - x[1] - (xy < 0 ? -xy : xy); ly = y[2] - y[1]; getline a; next }
  NF == 13 && step > 0 {
    split(F[step], f, " ")
    c = f[1] / sqrt(f[1] ^ 2 + f[3] ^ 2); s = f[3] / sqrt(f[1] ^ 2 + f[3] ^ 2)
    u = f[1] * X[$10] + f[2] * Y[$10]; v = f[3] * X[$10] + f[4] * Y[$10]
    if (!close_to($3 + $6 * lx + $7 * xy, c * u + s * v) || !close_to($4 + $7 * ly, c * v - s * u)) exit 1
    n++; moved += $6 != 0 || $7 != 0
  }
  END { exit !(n > 50 && moved > 10) }' "$packing" far.dump
check "the dump has rotations" grep -q '^ITEM: ATOMS .* theta$' rub.dump
native --path path.csv --friction-coefficient "$(awk 'BEGIN {p = atan2(0, -1) / 9; printf "%.17g", sin(p) / cos(p)}')" --hardening 10 -o mu.csv 2>/dev/null
native --path path.csv --friction-angle 20 --hardening 10 --hardening-law proportional -o proportional.csv 2>/dev/null
check "proportional hardening is another law" /usr/bin/python3 -c '
import csv
printed, proportional = (list(csv.DictReader(open(f)))[-1] for f in ("rub.csv", "proportional.csv"))
assert float(proportional["P12"]) != float(printed["P12"]) and float(proportional["dissipation"]) > 0'
check "the coefficient is the tangent of the angle" /usr/bin/python3 -c '
import csv
a, b = ([float(r["P12"]) for r in csv.DictReader(open(f))] for f in ("rub.csv", "mu.csv"))
assert max(abs(x - y) for x, y in zip(a, b)) < 1e-9'
if [ -n "$states" ]; then
  rubbing --path first.csv -o first_out.csv --save-state rub.h5 2>/dev/null
  rubbing --path second.csv -o second_out.csv --load-state rub.h5 2>/dev/null
  numbers() { cut -d, -f1-17,19-21 "$1"; } # all but the seconds
  check "friction: saved and loaded, a path continues to the last digit" diff <(numbers rub.csv | sed -n 4,5p) <(numbers second_out.csv | sed 1d)
  /usr/bin/python3 -c 'import h5py; h5py.File("other.h5", "w")["x"] = [1.0]'
fi

# --- bad input: exit 2, one message, nothing written ---
refused() { refused_by rve "$@"; }
p=$packing
o="-o out.csv --tangent tan.csv --dump a.dump${states:+ --save-state s.h5}"
# shellcheck disable=SC2086
{
  refused "no packing" "which packing?" --path ../path.csv $o
  refused "two packings" "one packing at a time" $p $p --path ../path.csv $o
  refused "no path" "--path is missing" $p $o
  refused "unknown option" "unknown option --boundery" $p --path ../path.csv --boundery taylor $o
  refused "option without value" "--path needs a value" $p $o --path
  refused "unknown boundary condition" 'not "tractions"' $p --path ../path.csv --boundary tractions $o
  refused "unknown engine" 'not "yade"' $p --path ../path.csv --engine yade $o
  refused "unknown relaxation" '--relaxation must be polished, damped or fire, not "newton"' $p --path ../path.csv --relaxation newton $o
  for value in 0 -5 nan inf 1e999 abc 50x ""; do
    refused "stiffness '$value'" "--normal-stiffness must be a positive number, not \"$value\"" $p --path ../path.csv --normal-stiffness "$value" $o
    refused "tolerance '$value'" "--tolerance must be a positive number, not \"$value\"" $p --path ../path.csv --tolerance "$value" $o
  done
  refused "tolerance 1" "--tolerance must be below 1" $p --path ../path.csv --tolerance 1 $o
  for value in 0 -3 1.5 many; do
    refused "--max-steps $value" "--max-steps must be an integer from 1 to 1000000000, not \"$value\"" $p --path ../path.csv --max-steps "$value" $o
  done
  refused "missing packing" "none.data: " none.data --path ../path.csv $o
  refused "missing path" "none.csv: " $p --path none.csv $o
  refused "packing that is a folder" "is a folder" .. --path ../path.csv $o
  : >empty
  refused "empty packing" "empty" ../empty --path ../path.csv $o
  refused "empty path" "empty" $p --path ../empty $o
  head -n 30 $p >cut.data
  refused "truncated packing" "cut.data:30: " ../cut.data --path ../path.csv $o
  sed 's/^7 1 /8 1 /' $p >twice.data
  refused "two grains with one id" "id 8 occurs twice" ../twice.data --path ../path.csv $o
  for value in 0 -0.1; do
    sed "s/^7 1 [0-9.]*/7 1 $value/" $p >radius.data
    refused "diameter $value" "radius.data:18: grain 7 has the diameter $value" ../radius.data --path ../path.csv $o
  done
  sed "s/^7 1 [0-9.]*/7 1 nan/" $p >nan.data
  refused "diameter nan" "nan.data:18: diameter: 'nan'" ../nan.data --path ../path.csv $o
  sed '/^7 1 /s/0.0$/0.5/' $p >z.data
  refused "a grain out of the plane" "z.data:18: grain 7 has z = 0.5" ../z.data --path ../path.csv $o
  row() { printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n%s\n' "$1" >bad.csv; }
  row 1,1,0,0,-1 && refused "det F < 0" "bad.csv:3: F = [1 0; 0 -1] has the determinant -1" $p --path ../bad.csv $o
  row 1,1,1,1,1 && refused "det F = 0" "bad.csv:3: F = [1 1; 1 1] has the determinant 0" $p --path ../bad.csv $o
  row 1,nan,0,0,1 && refused "NaN in F" "bad.csv:3: " $p --path ../bad.csv $o
  row 1,1,0,0 && refused "a short row" "bad.csv:3: " $p --path ../bad.csv $o
  row 1,one,0,0,1 && refused "a word in F" "bad.csv:3: " $p --path ../bad.csv $o
  row 0.5,1,0,0,1 && refused "half a step" "bad.csv:3: step 0.5 is not an integer" $p --path ../bad.csv $o
  printf 'step,F11,F12,F21\n0,1,0,0\n' >bad.csv && refused "no column F22" "no column F22" $p --path ../bad.csv $o
  printf 'step,F11,F12,F21,F22\n' >bad.csv && refused "a path without rows" "bad.csv" $p --path ../bad.csv $o
  E="--normal-stiffness 1000"
  for value in -1 90 nan abc; do
    refused "friction angle $value" "--friction-angle must be an angle in degrees" $p --path ../path.csv --friction-angle "$value" $o
  done
  refused "negative friction" "--friction-coefficient must be a number that is 0 or more" $p --path ../path.csv --friction-coefficient -0.1 $o
  refused "negative hardening" "--hardening must be a number that is 0 or more" $p --path ../path.csv --friction-angle 20 --hardening -1 $o
  refused "law of hardening" "--hardening-law must be printed or proportional" $p --path ../path.csv --friction-angle 20 --hardening-law half $o
  refused "no tangential stiffness" "--tangential-stiffness must be a positive number" $p --path ../path.csv --friction-angle 20 --tangential-stiffness 0 $o
  refused "rotations" "--rotations must be free or fixed" $p --path ../path.csv --friction-angle 20 --rotations maybe $o
  refused "angle and coefficient" "say the same" $p --path ../path.csv --friction-angle 20 --friction-coefficient 0.3 $o
  for option in "--tangential-stiffness 1" "--hardening 1" "--hardening-law printed" "--rotations fixed" "--slip objective"; do
    refused "$option without friction" "${option%% *} needs friction" $p --path ../path.csv $option $o
  done
  if [ -n "$states" ]; then
    refused "state with other hardening" "another contact law: hardening was 10, now it is 0" $p --path ../path.csv $E --friction-angle 20 --load-state ../rub.h5 $o
    refused "state with the other law of hardening" "another contact law: law of hardening (0 printed, 1 proportional) was 0, now it is 1" $p --path ../path.csv $E \
      --friction-angle 20 --hardening 10 --hardening-law proportional --load-state ../rub.h5 $o
    refused "state with friction" "another contact law: friction (1) or none (0) was 1, now it is 0" $p --path ../path.csv $E --load-state ../rub.h5 $o
    refused "missing state" "none.h5" $p --path ../path.csv --load-state none.h5 $o
    refused "state that is none" "path.csv" $p --path ../path.csv --load-state ../path.csv $o
    refused "state of a packing of another size" "a packing of 50 grains, and this one has 20" "$root/tests/data/cases/packings/p20.data" --path ../path.csv --load-state ../state.h5 $o
    refused "state of other boundary conditions" "saved with --boundary periodic, and now it is taylor-cell" $p --path ../path.csv --boundary taylor-cell --load-state ../state.h5 $o
    awk '$1 == 7 && NF >= 7 { $5 += 1e-9 } { print }' CONVFMT=%.17g OFMT=%.17g $p >moved.data
    refused "state of a packing with a grain elsewhere" "another packing: there grain 7 has the radius" ../moved.data --path ../path.csv --load-state ../state.h5 $o
    awk '$1 == 7 && NF >= 7 { $3 *= 1.01 } { print }' CONVFMT=%.17g OFMT=%.17g $p >grown.data
    refused "state of a packing with a larger grain" "another packing: there grain 7 has the radius" ../grown.data --path ../path.csv --load-state ../state.h5 $o
    awk '/xlo/ { $2 += 1e-6 } { print }' CONVFMT=%.17g OFMT=%.17g $p >wide.data
    refused "state of a packing with another cell" "another packing, with the cell" ../wide.data --path ../path.csv --load-state ../state.h5 $o
    refused "results for a state" "has no checksum" $p --path ../path.csv --load-state ../other.h5 $o
  fi
}
mkdir folder
native --path path.csv -o folder >said 2>&1
check "results that would replace a folder are refused" test $? != 0
native --path path.csv -o none/out.csv >said 2>&1
check "results in a folder that does not exist are refused, by name" grep -q none/out.csv said

# --- no convergence: exit 1, the rows before are kept ---
cat >jump.csv <<'END'
step,F11,F12,F21,F22
0,1.1,0,0,1.1
1,1.05,0,0,1.05
2,0.97,0,0,0.97
3,0.96,0,0,0.96
END
native --path jump.csv --relaxation damped --max-steps 3 -o out.csv --tangent tan.csv --dump a.dump ${states:+--save-state no.h5} >said.out 2>said.err
check "too few steps: exit 1" test $? = 1
check "the message names the step" grep -q 'step 2: .*no equilibrium within 3 relaxation steps' said.err
check "the rows before are kept" test "$(cut -d, -f1 out.csv | tr '\n' ' ')" = "step 0 1 "
check "so are tangents and frames" test "$(wc -l <tan.csv) $(frames a.dump)" = "3 2"
check "no state is saved, nothing is left over" test ! -e no.h5 -a -z "$(ls ./*.tmp 2>/dev/null)"
check "a full device is reported, exit 1" sh -c "'$granhom' rve '$packing' --engine native --path path.csv >/dev/full 2>said; test \$? = 1 && test \$(grep -c ^granhom said) = 1"
check "help lists the options" sh -c "'$granhom' help rve | grep -q -- --load-state"
exit $bad
