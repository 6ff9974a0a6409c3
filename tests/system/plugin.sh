#!/usr/bin/env bash
# granhom's styles in LAMMPS's own program: preloaded, and by `plugin load` where it has the package PLUGIN. The program `granhom lammps`
# with the same script is the standard. LMP, PLUGIN: another program than the installed
# lmp and its plugin. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say, check
begin
plugin=${PLUGIN:-$BUILD/granhomplugin.so}
lmp=${LMP:-lmp}
inputs=$root/lammps-inputs
script() { "$@" -var data "$inputs/p150.data" -log none -screen none >said 2>said.err; }
for program in "$lmp" "$plugin"; do
  [ -n "$(command -v "$program")" ] && continue
  echo "skip - there is no $program"
  exit $bad
done
if [ "${SANITIZED:-0}" = 1 ]; then
  echo 'skip - a program without sanitizers cannot load a plugin with them'
  exit $bad
fi
[ "$(nm -D --defined-only "$plugin" | awk '{ print $3 }' | grep -vc -e '^lammpsplugin_init$' -e post_create)" = 0 ]
say $? 'the plugin exports what LAMMPS asks for and no more'
script "$granhom" lammps -in "$inputs/in.shear" -var out wanted.txt
say $? 'in.shear in granhom lammps'
[ "$(wc -l <wanted.txt)" = 21 ]; say $? 'which writes 20 steps'

# ---- preloaded: works where the program calls post_create through the table of symbols, as Debian's does ----
preloaded() { env LD_PRELOAD="$plugin" "$lmp" "$@"; }
if ldd "$(command -v "$lmp")" 2>/dev/null | grep -q liblammps && [ -z "${LMP:-}" ]; then
  script preloaded -in "$inputs/in.shear" -var out got.txt && cmp -s wanted.txt got.txt
  say $? 'in.shear in lmp with the plugin preloaded: the same to the last bit'
  { printf 'pair_style granhom/coulomb\nclear\n'; cat "$inputs/in.shear"; } >clear.in
  script preloaded -in clear.in -var out got.txt && cmp -s wanted.txt got.txt
  say $? 'and after clear'
  script preloaded -in "$inputs/in.friction" -var out got.txt -var inner yes &&
    script "$granhom" lammps -in "$inputs/in.friction" -var out friction.txt -var inner yes && cmp -s friction.txt got.txt
  say $? 'in.friction too'
  printf 'atom_style sphere\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\npair_style granhom/normal\npair_coeff * * -1\n' >wrong.in
  preloaded -in wrong.in -log none >said 2>&1
  code=$?
  [ $code != 0 ] && grep -q 'ERROR.*granhom/normal' said
  say $? 'an error of a style is an error of lmp, with its words'
else
  echo 'skip - this lmp has no liblammps.so of the package'
fi

# ---- plugin load ----
if ! "$lmp" -h 2>/dev/null | grep -qw PLUGIN; then
  echo 'skip - plugin load: the installed LAMMPS was built without the package PLUGIN'
  exit $bad
fi
if ! nm -D --defined-only "$plugin" | grep -qw lammpsplugin_init; then
  echo 'skip - plugin load: the plugin was built without lammpsplugin.h; make plugin LAMMPS=SOURCES_OF_LAMMPS/src'
  exit $bad
fi
{ echo "plugin load $plugin"; cat "$inputs/in.shear"; } >loaded.in
rm -f got.txt
script "$lmp" -in loaded.in -var out got.txt && cmp -s wanted.txt got.txt
say $? 'plugin load and in.shear: the same to the last bit'
{ echo "plugin load $plugin"; cat "$inputs/in.friction"; } >loaded.in
script "$lmp" -in loaded.in -var out got.txt -var inner yes &&
  script "$granhom" lammps -in "$inputs/in.friction" -var out friction.txt -var inner yes && cmp -s friction.txt got.txt
say $? 'plugin load and in.friction'
exit $bad
