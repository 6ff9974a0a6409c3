#!/usr/bin/env bash
# Several ranks: LAMMPS scripts give the same figures, what runs on one rank refuses, errors have one message and the right exit status.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say
begin
inputs=$root/lammps-inputs
# told CODE WORDS NAME: the last command ended with CODE and said WORDS in its only message of granhom
told() {
  [ $code = "$1" ] && [ "$(grep -c '^granhom' said.err)" = 1 ] && grep -q "^granhom.*$2" said.err
  say $? "$3"
}

# --- one rank ---
"$granhom" lammps -in none.in >said 2>said.err; code=$?
told 2 'cannot open the input script none.in' 'a missing script: exit 2'
"$granhom" lammps -in . >said 2>said.err; code=$?
told 2 'cannot open the input script .' 'a folder for a script: exit 2'
printf 'units lj\npair_style nothing\n' >error.in
"$granhom" lammps -in error.in -log none >said 2>said.err; code=$?
told 1 "LAMMPS: Unrecognized pair style 'nothing'" "an error of LAMMPS: its message, exit 1"
printf 'units lj\nquit 7\n' >quit.in
"$granhom" lammps -in quit.in -log none >said 2>said.err; code=$?
[ $code = 7 ]; say $? "the exit status of a script's quit"
"$granhom" lammps -in "$inputs/in.shear" -var data "$inputs/p150.data" -var out one.txt -log none -screen none >said 2>said.err
say $? 'the shear loop runs on one rank'
[ "$(wc -l <one.txt)" = 21 ]; say $? 'and writes its twenty steps'

# --- two ranks ---
has MPI "two ranks" || exit $bad
if ! command -v mpirun >/dev/null; then
  echo 'skip - there is no mpirun'
  exit $bad
fi
if ! mpirun -n 2 true >said 2>said.err; then
  echo "skip - mpirun does not start here: $(head -n 1 said.err)"
  exit $bad
fi
# ranks COMMAND...: on two ranks; code: that of both when they agree. (mpirun would end one rank when the other has failed.)
cat >each.sh <<'E2'
"$@"
echo $? >code.$OMPI_COMM_WORLD_RANK
E2
ranks() {
  rm -f code.0 code.1
  mpirun -n 2 sh each.sh "$@" >said 2>said.err
  code=$(cat code.0)
  [ "$code" = "$(cat code.1)" ] || code="$code and $(cat code.1)"
}
ranks "$granhom" lammps -in "$inputs/in.shear" -var data "$inputs/p150.data" -var out two.txt -log none -screen none
[ "$code" = 0 ]; say $? 'the shear loop runs on two ranks'
# Stresses near 0.6, converged to 1e-9 of the contact forces
awk 'NR == FNR { for (c = 1; c <= 4; c++) a[FNR, c] = $c; next }
  FNR > 1 { for (c = 1; c <= 4; c++) { d = $c - a[FNR, c]; if (d < 0) d = -d; if (d > 2e-9) exit 1; n++ } }
  END { if (n != 80) exit 1 }' one.txt two.txt
say $? 'and gives the figures of one rank'
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n' >path.csv
ranks "$granhom" rve "$inputs/p150.data" --path path.csv -o out.csv
told 2 'runs on one rank, and it was started on 2' 'rve refuses two ranks: exit 2 on both'
[ ! -e out.csv ]; say $? 'and writes nothing'
ranks "$granhom" lammps -in none.in
told 2 'cannot open the input script none.in' 'a missing script on two ranks: exit 2 on both'
ranks "$granhom" lammps -in error.in -log none
told 1 "LAMMPS: Unrecognized pair style 'nothing'" 'an error of LAMMPS on two ranks: exit 1 on both'
exit $bad
