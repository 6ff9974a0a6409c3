#!/usr/bin/env bash
# `granhom element` as users run it: biaxial, undrained, constant pressure and cyclic tests, tables, states, bad input.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, ok, not_ok, check
begin
sand=$root/scenes/block/sand150.data
element() { "$granhom" element "$sand" --engine native --normal-stiffness 50 "$@"; }
# table FILE PROGRAM: awk's PROGRAM sets `wrong` where a row is; v("s11") is a column of the row, n counts from the start
table() {
  awk -F, 'function v(name) { return $(c[name]) } function abs(x) { return x < 0 ? -x : x }
    NR == 1 { for (k = 1; k <= NF; k++) c[$k] = k; next } { n = NR - 2 } '"$2"' END { exit wrong || NR < 3 }' "$1"
}

# --- biaxial compression ---
cat >biaxial.yaml <<'END'
title: Biaxial compression under a side stress of 0.2
steps:
  - {name: consolidate, increments: 5, control: {s11: -0.2, s22: -0.2, s12: 0}}
  - {name: compress, increments: 12, control: {F22: {by: -0.006}, s11: hold, s12: hold}}
END
element --control biaxial.yaml --friction-coefficient 0.3 --stress-tolerance 1e-9 -o biaxial.csv >said 2>&1
check "biaxial compression with friction" test $? = 0 -a "$(wc -l <biaxial.csv)" = 19
columns=step,F11,F12,F21,F22,P11,P12,P21,P22,s11,s12,s21,s22,energy,contacts,rattlers,residual,seconds
check "the columns are those of granhom rve and those of the control" test "$(head -n 1 biaxial.csv)" = \
  $columns,energy_t,dissipation,sliding,load_step,volume,pressure,iterations,parts,cuts,jumps,mismatch
element --control biaxial.yaml --friction-coefficient 0.3 --stress-tolerance 1e-9 --quiet -o quiet.csv >quiet 2>&1
check "--quiet: the same results, and not a word" test $? = 0 -a ! -s quiet -a -z "$(diff <(cut -d, -f1-17 biaxial.csv) <(cut -d, -f1-17 quiet.csv))"
check "nothing to say where relaxation has come to its end" test "$(grep -c 'accepted unconverged' said)" = 0
element --control biaxial.yaml --friction-coefficient 0.3 --max-steps 30 --accept 1 --stress-tolerance 0.1 -o taken.csv >said 2>&1
check "--accept accepts a packing unconverged, and each increment reports it" test $? = 0 -a "$(grep -c 'step [1-9][0-9]*: accepted unconverged, with a residual of' said)" -ge 10
awk 'BEGIN { print "F11,F12,F21,F22"; for (k = 1; k <= 240; k++) print "0.97," k / 200 ",0,0.97" }' >far.csv
far() { "$granhom" "$1" "$root/tests/data/cases/packings/p20.data" --engine native --tangential-stiffness 0.8 --friction-angle 21 --tolerance 1e-11 \
  --integration "$2" --path "$3" -o "$4" >said 2>&1; }
check "sheared far" far element ramp far.csv far_element.csv
head -n 121 far.csv >less_far.csv
far element whole less_far.csv far_element.csv
far rve whole less_far.csv far_rve.csv
# The committed start has slips of round-off.
check "with F prescribed it is granhom rve" awk -F, 'FNR == 1 { next }
  NR == FNR { for (k = 2; k < 10; k++) a[$1, k] = $k; next }
  { for (k = 2; k < 10; k++) if (($k - a[FNR - 1, k]) ^ 2 > (k < 6 ? 0 : 1e-18)) bad = 1; rows++ }
  END { exit bad || rows != 120 }' far_element.csv far_rve.csv
check "consolidation ends at the pressure" table biaxial.csv \
  'n == 5 && (abs(v("s11") + 0.2) > 2e-10 || abs(v("s22") + 0.2) > 2e-10) { wrong = 1 }'
check "the side stress stays, the shear stress stays zero" table biaxial.csv \
  'n > 5 && (abs(v("s11") + 0.2) > 1e-9 || abs(v("s12")) > 1e-9 || v("mismatch") > 1e-9) { wrong = 1 }'
check "no rotation" table biaxial.csv 'n > 0 && abs(v("F21")) > 1e-13 { wrong = 1 }'
check "the axial stress rises, the height falls evenly" table biaxial.csv \
  'n > 5 && (v("s22") >= last || abs(v("F22") - height + 0.0005) > 1e-12) { wrong = 1 } { last = v("s22"); height = v("F22") }'
check "load steps are counted" table biaxial.csv 'v("load_step") != (n > 5 ? 2 : n > 0) { wrong = 1 }'

# --- undrained, constant pressure, constrained compression ---
cat >undrained.yaml <<'END'
steps:
  - {name: consolidate, increments: 5, control: {pressure: 0.2, "s11 - s22": 0, s12: 0}}
  - {name: shear, increments: 8, control: {F12: {by: 0.004}, volume: hold, "s11 - s22": 0}}
END
check "undrained shear" element --control undrained.yaml --friction-angle 20 -o undrained.csv
check "the volume stays" table undrained.csv 'n == 5 { J = v("F11") * v("F22") - v("F12") * v("F21") }
  n > 5 && (abs(v("F11") * v("F22") - v("F12") * v("F21") - J) > 1e-12 || abs(v("volume") - J) > 1e-12) { wrong = 1 }'
check "shear stress grows with shear" table undrained.csv 'n == 13 && v("s12") < 0.02 { wrong = 1 }'
cat >pressure.yaml <<'END'
steps:
  - {name: consolidate, increments: 5, control: {pressure: 0.2, "F11 - F22": 0, F12: 0}}
  - {name: shear, increments: 8, control: {F12: {by: 0.004}, pressure: hold, F11: hold}}
  - {name: oedometer, increments: 4, control: {s22: {times: 1.5}, F11: hold, F12: hold}}
END
check "constant pressure shear, then an oedometer" element --control pressure.yaml --friction-angle 20 -o pressure.csv
check "the pressure stays, the width stays, the load rises" table pressure.csv \
  'n == 5 { F11 = v("F11") } n == 13 { s22 = v("s22"); F12 = v("F12") }
  n > 5 && n < 14 && abs(v("pressure") - 0.2) > 4e-7 { wrong = 1 } n > 5 && abs(v("F11") - F11) > 1e-13 { wrong = 1 }
  n == 17 && (abs(v("s22") - 1.5 * s22) > 1e-6 || abs(v("F12") - F12) > 1e-13) { wrong = 1 }'

# --- cycles ---
cat >cycles.yaml <<'END'
steps:
  - {increments: 3, control: {s11: -0.2, s22: -0.2, s12: 0}}
  - repeat: 2
    steps:
      - {increments: 3, control: {s12: 0.01, s11: hold, s22: hold}}
      - {increments: 20, control: {F12: {by: -0.004}, s11: hold, s22: hold}, until: {s12: -0.01}}
END
element --control cycles.yaml --friction-angle 20 -o cycles.csv >said 2>&1
check "cycles between two stress levels" test $? = 0
check "the steps are repeated, and until ends them with the first increment beyond" table cycles.csv \
  '{ l = v("load_step"); s = v("s12") } n && l == was && was_s < -0.01 { wrong = 1 } l % 2 == 0 && l != was { starts++ }
  l == 4 && was == 3 && was_s > -0.01 { wrong = 1 } { was = l; was_s = s }
  END { if (starts != 2 || l != 5 || s > -0.01 || n > 45) wrong = 1 }'

# --- the same in other words ---
cat >table.csv <<'END'
step,s11,s22,s12
1,-0.04,-0.04,0
2,-0.08,-0.08,0
3,-0.12,-0.12,0
END
cat >table.yaml <<'END'
steps:
  - {increments: 1, control: {s11: {by: -0.03}, s22: -0.04, s12: 0}}
  - {increments: 2, control: {s11: {times: 3}, s22: {to: -0.12}, s12: {by: 0}}}
END
element --path table.csv --friction-angle 20 -o by_table.csv 2>said
element --control table.yaml --friction-angle 20 -o by_yaml.csv 2>said
check "a table of targets" table by_table.csv 'n > 0 && abs(v("s11") + 0.04 * n) > 1e-7 { wrong = 1 }'
check "table and steps give the same" awk -F, 'FNR == 1 { next } NR == FNR { for (k = 2; k < 15; k++) a[FNR, k] = $k; next }
  { for (k = 2; k < 15; k++) if (($k - a[FNR, k]) ^ 2 > 1e-13) exit 1; rows++ } END { if (rows != 4) exit 1 }' by_table.csv by_yaml.csv
element --path - --friction-angle 20 <table.csv >piped.csv 2>/dev/null
check "table from standard input, results to standard output" diff <(cut -d, -f1-17 by_table.csv) <(cut -d, -f1-17 piped.csv)

cat >first.yaml <<'END'
steps: [{increments: 5, control: {pressure: 0.2, "F11 - F22": 0, F12: 0}}]
END
# --- against the other engine, and against granhom rve along the F that came out ---
element --control first.yaml --friction-angle 20 -o native.csv 2>/dev/null
element --control first.yaml --friction-angle 20 --engine lammps -o lammps.csv 2>/dev/null
check "LAMMPS and the native engine agree" awk -F, 'FNR == 1 { next } NR == FNR { for (k = 2; k < 14; k++) a[FNR, k] = $k; next }
  { for (k = 2; k < 14; k++) if (($k - a[FNR, k]) ^ 2 > 1e-14) exit 1; rows++ } END { if (rows != 6) exit 1 }' native.csv lammps.csv
check "no bisections, no instabilities on this path" table pressure.csv 'v("parts") != 1 || v("jumps") { wrong = 1 }'
# Along F slip is integrated to the last row of each increment, in an element test to the first iterate.
for way in ramp whole; do
  element --control pressure.yaml --friction-angle 20 --integration $way -o pressure_$way.csv 2>/dev/null
  cut -d, -f1-5 pressure_$way.csv >path.csv
  "$granhom" rve "$sand" --engine native --normal-stiffness 50 --friction-angle 20 --tolerance 1e-10 --integration $way --path path.csv \
    -o rve_$way.csv 2>/dev/null
  limit=$([ $way = ramp ] && echo 2e-3 || echo 1e-8)
  check "granhom rve along F gives the same stresses and energies, $way" awk -F, -v limit=$limit 'FNR == 1 { next }
    NR == FNR { for (k = 6; k < 15; k++) a[FNR, k] = $k; if ($14 > most) most = $14; next }
    { for (k = 6; k < 15; k++) { d = $k - a[FNR, k]; if (d * d > limit * limit * 0.09) bad = 1 } rows++ }
    END { exit bad || rows < 10 }' pressure_$way.csv rve_$way.csv
done

# --- the worked examples; a packing without friction, which rearranges on the way ---
for test in undrained constant_pressure; do
  check "scenes/element/$test.yaml" element --control "$root/scenes/element/$test.yaml" --friction-coefficient 0.3 -o scene_$test.csv
done
check "the undrained path" table scene_undrained.csv 'n > 10 && abs(v("volume") - J) > 1e-12 { wrong = 1 } { J = v("volume") }
  n == 70 && v("s12") < 0.05 { wrong = 1 }'
cat >jump.yaml <<'END'
steps: [{increments: 1, control: {s11: -0.029, s22: -0.029, s12: 0}}]
END
element --control jump.yaml -o jump.csv >said 2>&1
check "a jump is passed" table jump.csv \
  'n == 1 && (v("jumps") < 1 || v("mismatch") > 1e-6 || abs(v("s11") + 0.029) > 1e-7) { wrong = 1 }'
check "and told" grep -q 'passed by servo control, in 1 of 1 increments' said
element --control jump.yaml --stop-at-jumps -o stopped.csv >said 2>&1
check "or the test ends there" test $? = 1

# --- states ---
cat >second.yaml <<'END'
steps: [{increments: 8, control: {F12: {by: 0.004}, pressure: 0.2, F11: hold}}]
END
if has HDF5 states; then
  check "a state is saved" element --control first.yaml --friction-angle 20 --save-state state.h5 -o first.csv
  check "and loaded" element --control second.yaml --friction-angle 20 --load-state state.h5 -o second.csv
  # With friction, a state is the end of a step, and the start is an empty step from there: it differs a little.
  check "the test continues from it" awk -F, 'FNR == 1 { next } NR == FNR { a[FNR] = $10; b[FNR] = $11; next }
    FNR > 2 { if (($10 - a[FNR + 5]) ^ 2 > 4e-10 || ($11 - b[FNR + 5]) ^ 2 > 4e-10) exit 1; rows++ } END { if (rows != 8) exit 1 }' pressure.csv second.csv
fi

# --- more than the packing can carry ---
cat >much.yaml <<'END'
steps:
  - {name: consolidate, increments: 2, control: {s11: -0.02, s22: -0.02, s12: 0}}
  - {name: overload, increments: 2, control: {s12: 0.02, s11: hold, s22: hold}}
END
element --control much.yaml --friction-angle 10 --cut-steps 2 --max-steps 20000 --stop-at-jumps -o much.csv >said 2>&1
check "a stress beyond the strength: exit 1" test $? = 1
check "the message names step, increment and reason" grep -q \
  '^granhom: overload, increment [12] of 2: no equilibrium after 2 bisections and 0 instabilities stepped over: ' said
check "the rows before it are written" test "$(tail -n 1 much.csv | cut -d, -f1)" -ge 2

# --- bad input: exit 2, one message, nothing written ---
# refused NAME WORDS COMMAND...
refused() {
  local name=$1 words=$2
  shift 2
  rm -f none.csv
  "$@" -o none.csv >said 2>&1
  local code=$?
  if [ $code = 2 ] && grep -qF -e "$words" said && [ ! -e none.csv ]; then ok "$name"; else not_ok "$name" "exit $code" "$(cat said)"; fi
}
spec() { # spec TEXT [OPTION...]: a control file of this text
  printf '%s\n' "$1" >bad.yaml
  element --control bad.yaml "${@:2}"
}
one() { spec "steps: [{increments: 1, control: $1}]" "${@:2}"; }
good='{s11: -0.02, s22: -0.02, s12: 0}'
refused "an unknown relaxation" '--relaxation must be polished, damped or fire, not "cg"' element --control table.yaml --relaxation cg
refused "neither steps nor table" "give one of --control and --path" element
refused "both" "give one of --control and --path" element --control table.yaml --path table.csv
refused "no such file" "none.yaml" element --control none.yaml
refused "two conditions" "bad.yaml:1: control has 2 conditions; it needs three" one '{s11: 0, s22: 0}'
refused "an unknown quantity" 'bad.yaml:1: "s13" is no condition' one '{s11: 0, s22: 0, s13: 0}'
refused "stress and deformation in one" "it mixes stress and deformation" one '{s11 - F11: 0, s22: 0, s12: 0}'
refused "a target that is none" "s12 must be a number, hold, {to: x}, {by: x} or {times: x}" one '{s11: 0, s22: 0, s12: keep}'
refused "a target that is not finite" "s12" one '{s11: 0, s22: 0, s12: .nan}'
refused "an unknown way" "bye" one '{s11: 0, s22: 0, s12: {bye: 1}}'
refused "two ways" "give one of to, by and times" one '{s11: 0, s22: 0, s12: {by: 1, to: 1}}'
refused "no increments" "bad.yaml:1: a step needs the key 'increments'" spec 'steps: [{control: {s11: 0, s22: 0, s12: 0}}]'
refused "no control" "a step needs the key 'control'" spec 'steps: [{increments: 1}]'
refused "no steps" "steps must be a list of at least one step" spec 'steps: []'
refused "an unknown key" "stepps" spec 'stepps: []'
refused "until of two" "until must be a map of one condition" spec "steps: [{increments: 1, control: $good, until: {s11: 0, s22: 0}}]"
refused "repeated without number" "repeat" spec "steps: [{repeat: many, steps: [{increments: 1, control: $good}]}]"
printf 'step,s11,s22\n1,0,0\n' >bad.csv
refused "a table with two conditions" "bad.csv:1: 2 conditions; a row needs three" element --path bad.csv
printf 'step,s11,s22,s12,F21,F12\n1,0,0,0,0,0\n' >bad.csv
refused "a table with five" "bad.csv:1: more than four conditions" element --path bad.csv
printf 'step,s11,s22,q\n1,0,0,0\n' >bad.csv
refused "a table with an unknown column" 'bad.csv:1: "q" is no condition' element --path bad.csv
refused "a negative stiffness" "--normal-stiffness must be a positive number" one "$good" --normal-stiffness -1
refused "both ways of friction" "give one of them" one "$good" --friction-angle 20 --friction-coefficient 0.3
refused "an angle of 90 degrees" "below 90" one "$good" --friction-angle 90
refused "friction's options without friction" "--hardening needs friction" one "$good" --hardening 1
refused "another word for rotations" "--rotations must be free or fixed" one "$good" --friction-angle 20 --rotations none
refused "a tolerance of one" "--stress-tolerance must be below 1" one "$good" --stress-tolerance 1
refused "an unknown option" "unknown option --stresses" one "$good" --stresses 1
refused "conditions that follow from each other" "bad.yaml:1: the four conditions do not determine F" one '{s11: -0.02, 2 s11: -0.04, s12: 0}'

exit $bad
