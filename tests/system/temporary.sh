#!/usr/bin/env bash
# Folders for temporary files: a TMPDIR with blanks and the like, what a kill leaves, what must stay; programs whose names a shell would
# interpret. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, check
begin
packing=$root/tests/data/cases/packings/p50d.data
unset OMPI_MCA_orte_tmpdir_base # as users run it
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.9995,0,0,1\n' >path.csv
rve() { "$granhom" rve "$packing" --normal-stiffness 1000 --path path.csv -o out.csv >said 2>said.err; }
cross() { "$granhom" crosscheck "$packing" --normal-stiffness 1000 --path path.csv --engines native,liggghts "$@" >table 2>said.err; }
# wait_for COMMAND...: until it succeeds, 20 s at most
wait_for() { for _ in $(seq 200); do "$@" && return; sleep 0.1; done; return 1; }

for name in 'with a blank' "quote ' and \"" 'dollar $(touch pwned) & ;#'; do
  mkdir "$work/$name"
  export TMPDIR="$work/$name"
  rve; check "TMPDIR $name: exit 0" test $? = 0
  check "  nothing is left" test -z "$(ls -A "$TMPDIR" | grep -v "^ompi[.]")" # Open MPI 5 leaves a folder
  # a stand-in for LIGGGHTS that reports how it was called
  cat >"sub $name" <<'E2'
#!/bin/sh
[ "$*" = '-in in.path -log none' ] && [ "$(pwd)" = "$TMPDIR" ] && grep -q '^read_data packing.data$' in.path && grep -q '^50 atoms' packing.data &&
  ! grep -q "$TMPDIR" in.path && echo 'ERROR: called well'
exit 3
E2
  chmod +x "sub $name"
  cross --liggghts "./sub $name" -o "cross $name"
  check "  a program by a name with the same: called without a shell" grep -q 'status 3: ERROR: called well' table
  check "  nothing is left" test -z "$(ls -A "$TMPDIR" | grep -v "^ompi[.]")" # Open MPI 5 leaves a folder
  mkdir "bin $name" && cp "sub $name" "bin $name/stand-in"
  PATH="$PATH:$work/bin $name" cross --liggghts stand-in -o "path $name"
  check "  found in PATH" grep -q 'ERROR: called well' table
done
check 'no shell has interpreted a name' test -z "$(find . -name pwned)"

export TMPDIR=$work/path.csv
rve; check 'TMPDIR that is a file: exit 1' test $? = 1
check '  and why, in one line' sh -c "grep -q '^granhom: TMPDIR = $TMPDIR: no folder for temporary files can be made there' said.err && [ \$(wc -l <said.err) = 1 ]"
export TMPDIR=$work/new/folder
rve; check 'TMPDIR that is not there: it is made' test $? = 0 -a -d "$TMPDIR"

# --- what a kill leaves is removed at the next start; what lives, belongs to others or has another name stays ---
export TMPDIR=$work/tmp
mkdir tmp keep
echo precious >keep/file
export TMPDIR=$work/tmp
printf '#!/bin/sh\nln -s "%s" link\nmkdir sub\nln -s "%s/file" sub/link\n: >started\nexec sleep 100\n' "$work/keep" "$work/keep" >hang && chmod +x hang
started() { compgen -G "$work/tmp/granhom-liggghts-*/started" >there && [ "$(wc -l <there)" = "$1" ]; }
hanging() { exec "$granhom" crosscheck "$packing" --normal-stiffness 1000 --path path.csv --engines native,liggghts --liggghts ./hang -o "$1" >/dev/null 2>&1; }
hanging killed & first=$!
check 'a program at work' wait_for started 1
hanging living & second=$!
check 'two' wait_for started 2
rve
check 'folders in use stay' started 2
kill -9 $first && wait $first 2>/dev/null
check 'a kill leaves folders' test "$(find tmp -maxdepth 1 -name "granhom-*-$first-*" | wc -l)" = 2
mkdir tmp/granhom-results tmp/granhom-mpi-1-abcdef tmp/other-mpi-1-abcdef
ln -s "$work/keep" tmp/granhom-mpi-2-abcdef
mkdir tmp/granhom-mpi-3-abcdef && ln -s "$work/keep/file" tmp/granhom-mpi-3-abcdef/.granhom-lock
rve
check 'the next start removes them' test "$(find tmp -maxdepth 1 -name "granhom-*-$first-*" | wc -l)" = 0
check 'those of the living stay' test "$(find tmp -maxdepth 1 -name "granhom-*-$second-*" | wc -l)" = 2
check 'links are not followed' grep -qx precious keep/file
check 'other names and folders without a lock stay' test -d tmp/granhom-results -a -d tmp/granhom-mpi-1-abcdef -a -d tmp/other-mpi-1-abcdef -a -L tmp/granhom-mpi-2-abcdef -a \
  -d tmp/granhom-mpi-3-abcdef
if [ "$(id -u)" = 0 ]; then # of another user, with a lock that nobody holds
  mkdir tmp/granhom-mpi-4-abcdef && : >tmp/granhom-mpi-4-abcdef/.granhom-lock && chown -R 12345 tmp/granhom-mpi-4-abcdef
  rve
  check "another user's stays" test -d tmp/granhom-mpi-4-abcdef
else echo 'skip - not root: no folder of another user'; fi
kill $second && wait $second 2>/dev/null
exit $bad
