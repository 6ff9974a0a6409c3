#!/usr/bin/env bash
# Friction in LAMMPS scripts: the specimen of in.dns in small on one and two ranks, restarts to the last bit, history that migrates.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say, check
begin
inputs=$root/lammps-inputs
# near FILE FILE LIMIT: the same table, but for this difference over the largest figure of the first (the first column and line are names)
near() {
  awk -v limit="$3" 'NR == FNR { for (c = 2; c <= NF; c++) { a[FNR, c] = $c; v = $c < 0 ? -$c : $c; if (FNR > 1 && v > most) most = v } lines = FNR; next }
    FNR > 1 { for (c = 2; c <= NF; c++) { d = $c - a[FNR, c]; if (d < 0) d = -d; if (d > worst) worst = d; n++ } }
    END { printf "#   difference %.3g of %.3g\n", worst, most; exit !(n > 3 && FNR == lines && most > 0 && worst <= limit * most) }' "$1" "$2"
}
dns() { "$granhom" lammps -in "$inputs/in.dns" -var cells 16 -var steps 250 -log none -screen none "$@" >said 2>said.err; }

# same DUMP DUMP TABLE TABLE: a specimen and its second half from a restart file. LAMMPS 29 Sep 2021 repeats it to the last bit; later ones
# round the positions of a tilted box when they read the file, so that the stresses agree to round-off.
exact='or to round-off: this LAMMPS is not of 29 Sep 2021'
[ "$(pkg-config --modversion liblammps)" = 20210929 ] && exact=exactly
same() { if [ "$exact" = exactly ]; then cmp -s "$1" "$2" && cmp -s "$3" "$4"; else near "$3" "$4" 1e-11; fi; }

dns -var last one.dump -var out one.txt -var middle one.restart; say $? 'the specimen runs on one rank'
dns -var last again.dump -var out again.txt -var from one.restart; say $? 'and again from its restart file'
same one.dump again.dump one.txt again.txt; say $? "to the last bit ($exact)"

# What a restart may not be used for
cat >other.in <<'E2'
newton off
read_restart one.restart
pair_style granhom/coulomb
pair_coeff * * 1000 800 0.4 0
run 0
E2
"$granhom" lammps -in other.in -log none -screen none >said 2>said.err; code=$?
[ $code = 1 ] && grep -q '^granhom: .*other coefficients of the types 1 and 1 than the script: E_n 1000' said.err
say $? 'a restart with other coefficients: exit 1, and why'

# A specimen that is moved as a whole, by a jump between runs and by drifting through the box: what it feels stays.
cat >drift.in <<'E2'
variable        out index drift.txt
variable        jump index 0
variable        drift index 0
newton          off
read_restart    one.restart
neighbor        0.1 bin
neigh_modify    every 1 delay 0 check yes
timestep        0.01
fix             move all nve/sphere disc
fix             plane all enforce2d
compute         stress all granhom/stress
compute         rows all granhom/contact/local
variable        inputs string ""
if              "$(version) >= 20231121" then "variable inputs string 'inputs local'"
compute         turned all reduce sum c_rows[18] ${inputs}
run             0
displace_atoms  all move $(v_jump*lx) $(v_jump*ly) 0
velocity        all set $(v_drift) $(v_drift) 0 sum yes
thermo_modify   norm no
variable        sxx equal c_stress[1]
variable        sxy equal c_stress[2]
variable        syx equal c_stress[4]
variable        syy equal c_stress[5]
variable        force equal c_turned
thermo_style    custom step v_sxx v_sxy v_syx v_syy v_force
fix             record all print 20 "$(step) $(v_sxx:%.17g) $(v_sxy:%.17g) $(v_syx:%.17g) $(v_syy:%.17g) $(v_force:%.17g)" file ${out} screen no title "step sxx sxy syx syy f_t"
run             200
E2
drift() { "$granhom" lammps -in drift.in -log none -screen none "$@" >said 2>said.err; }
drift -var out still.txt; say $? 'the specimen without drag'
drift -var out jump.txt -var jump 0.37 && near still.txt jump.txt 1e-9; say $? 'moved by a part of the box: the same'
drift -var out drift.txt -var drift 10 && near still.txt drift.txt 1e-9; say $? 'drifting through the box: the same'

# The loop of in.friction: the tangent is the secant of the step while few contacts slide, and the loop stays open.
loop() { "$@" "$granhom" lammps -in "$inputs/in.friction" -var data "$inputs/p150.data" -log none -screen none -var out "$out" -var inner "$inner" >said 2>said.err; }
out=loop.txt inner=yes loop; say $? 'a loop of shear with friction'
awk 'NR > 1 { e = $7 / $8 - 1; if (e < 0) e = -e; if ($6 < 0.01 && e > 0.005 || e > 0.06) exit 1; n++; last = $3 }
  END { exit !(n == 20 && last > 0.01 && last < 0.03) }' loop.txt
say $? 'its tangent, and the stress that is left'

has MPI "two ranks" || exit $bad
if ! command -v mpirun >/dev/null; then
  echo 'skip - there is no mpirun'
  exit $bad
fi
if ! mpirun -n 2 true >said 2>said.err; then
  echo "skip - mpirun does not start here: $(head -n 1 said.err)"
  exit $bad
fi
two() { mpirun -n 2 "$granhom" lammps -log none -screen none "$@" >said 2>said.err; }
two -in "$inputs/in.dns" -var cells 16 -var steps 250 -var last two.dump -var out two.txt -var middle two.restart
say $? 'the specimen runs on two ranks'
near one.txt two.txt 1e-10; say $? 'with the same stresses to 1e-10'
two -in "$inputs/in.dns" -var cells 16 -var steps 250 -var last two.again -var out two.txt2 -var from two.restart && same two.dump two.again two.txt two.txt2
say $? "and again from its restart file, to the last bit ($exact)"
two -in drift.in -var out two.drift -var drift 10 && near still.txt two.drift 1e-9
say $? 'its history goes from rank to rank'
out=loop2.txt inner=no loop mpirun -n 2 && cut -d ' ' -f 1-5 loop.txt >a && cut -d ' ' -f 1-5 loop2.txt >b && near a b 1e-8
say $? 'the loop on two ranks: the same stresses'
cut -d ' ' -f 1,7 loop.txt >a && cut -d ' ' -f 1,7 loop2.txt >b && near a b 1e-4
say $? 'and tangents'
two -in other.in; [ $? != 0 ] && [ "$(grep -c '^granhom: .*other coefficients' said.err)" = 1 ]
say $? 'a restart with other coefficients: one message of two ranks'
exit $bad
