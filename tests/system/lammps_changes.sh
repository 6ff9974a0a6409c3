#!/usr/bin/env bash
# LAMMPS commands that change atoms behind the styles' back, between and within runs: right, or refused with the reason. And what a
# script may not do without --allow-shell. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say, check
begin
data=$root/lammps-inputs/p150.data
ranks=()
lammps() { "${ranks[@]}" "$granhom" lammps -in "$1" -log none -screen none "${@:2}" >said 2>said.err; }
# near VALUE EXPECTED TOLERANCE
near() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a - b; if (d < 0) d = -d; exit !(a != "" && a == a + 0 && d <= t) }'; }
# value NAME: what the script printed as "NAME VALUE" into out.txt
value() { awk -v name="$1" '$1 == name { v = $2 } END { print v }' out.txt; }
# right NAME [NAME VALUE TOLERANCE]...: in.x ends well and has printed these values
right() {
  local name=$1 faults=""
  shift
  rm -f out.txt
  lammps in.x || faults="exit $?; $(head -c 600 said.err)"
  while [ $# -gt 0 ] && [ -z "$faults" ]; do
    near "$(value "$1")" "$2" "$3" || faults="$1 is $(value "$1"), not $2"
    shift 3
  done
  if [ -z "$faults" ]; then ok "$name"; else not_ok "$name" "$faults"; fi
}
# refused NAME WORDS: in.x ends with exit 1 and one message with these words
refused() {
  lammps in.x
  local code=$?
  if [ $code != 0 ] && [ "$(grep -c '^granhom: ' said.err)" = 1 ] && grep -F "$2" said.err | grep -q '^granhom: '; then ok "refused: $1"
  else not_ok "refused: $1" "exit $code" "$(head -n 5 said.err)" "wanted: $2"; fi
}
out='append out.txt screen no'
# compute reduce of local data requires a keyword since LAMMPS 21 Nov 2023, which earlier versions do not know
local_input='variable inputs string ""
if "$(version) >= 20231121" then "variable inputs string '"'inputs local'"'"'

# ---- two disks (or spheres), closed forms: E = 100, E_t = 80, radii 0.5 and 0.4, overlap 0.1 along x ----
# two STYLE [COMMANDS OF BEFORE THE FIRST RUN]: head of in.x
two() {
  local style=$1 dimension=2 coefficients="100"
  [ "$style" = coulomb ] && coefficients="100 80 0.5 0"
  [ "$style" = normal3 ] && dimension=3 style=normal
  cat >in.x <<E2
dimension $dimension
atom_style sphere ${dynamic:-0}
atom_modify map array
newton off
boundary p p p
region box block 0 8 0 6 -2 2
create_box 2 box
create_atoms 1 single 2 3 0
create_atoms 2 single 2.8 3 0
set type 1 diameter 1
set type 2 diameter 0.8
${2:-}
pair_style granhom/$style
pair_coeff * * $coefficients
neighbor 0.1 bin
neigh_modify every 1 delay 0 check yes
thermo_modify norm no
timestep 0.001
fix v all viscous 0
E2
}
tell='print "pe $(pe)" '$out'
print "ecoul $(ecoul)" '$out'
print "evdwl $(evdwl)" '$out
more() { printf '%s\n' "$@" >>in.x; }

for style in normal normal3 coulomb; do
  two $style; more 'run 0' "$tell"; right "$style: two grains" pe 0.5 1e-12 ecoul 0 0
  two $style; more 'run 0' 'set type 2 diameter 1.4' 'run 0' "$tell"; right "$style: set diameter, larger than any before" pe 8 1e-11 ecoul 0 0
  two $style; more 'run 0' 'set type 2 diameter 1.4' 'run 1 pre no'; refused "$style: set diameter and pre no" 'the radius 0.7 of atom 2 exceeds 0.4'
  two $style; more 'run 0' 'set atom 1 type 2' 'run 0' "$tell"; right "$style: set type" pe 0.5 1e-12
  two $style; more 'run 0' 'set atom 1 type 2' 'run 1 pre no'; refused "$style: set type and pre no" 'the radius 0.5 of atom 1 exceeds 0.4, the largest of its type 2'
  dynamic=1 two $style; more 'fix a all adapt 1 atom diameter v_d' 'variable d equal 0.9+0.02*step' 'run 20'
  refused "$style: fix adapt with growing grains" 'the radius'
  dynamic=1 two $style; more 'group one id 1' 'fix a one adapt 1 atom diameter v_d' 'variable d equal 1-0.005*step' 'run 20' "$tell"
  right "$style: fix adapt with a grain that shrinks" pe 0.125 1e-3 # radius 0.45
  two $style; more 'run 0' 'set type 2 diameter 1.4' 'velocity all set 0 0 0' 'run 1 pre no' # velocity initialises
  refused "$style: set diameter, velocity and pre no" 'the radius 0.7 of atom 2 exceeds 0.4'
  two $style; more 'thermo_style custom step' 'neigh_modify delay 10' 'run 4' 'reset_timestep 0' 'displace_atoms all move 0.2 0 0' 'run 4 pre no'
  refused "$style: reset_timestep, displace_atoms and pre no" 'more than the neighbor skin'
  two $style; more 'run 0' 'compute r all cluster/atom 1' 'velocity all set 0 0 0' 'neigh_modify delay 10' 'run 1 pre no' "$tell"; right "$style: another list and pre no" pe 0.5 1e-3
  two $style; more 'run 0' 'pair_style zero 1' 'pair_coeff * *' 'run 0' "$(grep ^pair_style in.x)" "$(grep ^pair_coeff in.x)" 'run 1 pre no'
  refused "$style: another pair style and pre no" 'cannot follow the command pair_style'
  two $style; more 'run 0' 'create_atoms 1 single 2 3.95 0' 'run 0' "$tell" # as created: diameter 1, overlap 0.05
  right "$style: create_atoms" pe 0.625 1e-12 ecoul 0 0
  two $style; more 'run 0' 'neigh_modify delay 10' 'create_atoms 1 single 2 3.95 0' 'run 1 pre no'; refused "$style: create_atoms and pre no" 'cannot follow commands that add, remove'
  two $style; more 'run 0' 'group g id 2' 'delete_atoms group g' 'run 1 pre no'; refused "$style: delete_atoms and pre no" 'cannot follow commands that add, remove'
  two $style; more 'run 0' 'neigh_modify delay 10' 'displace_atoms all move 0.2 0 0' 'run 1 pre no'; refused "$style: displace_atoms and pre no" 'more than the neighbor skin'
  two $style; more 'run 0' 'displace_atoms all move 0.2 0 0' 'run 1 pre no' "$tell"; right "$style: displace_atoms and pre no with a new list" pe 0.5 1e-3
  two $style; more 'run 0' 'displace_atoms all move 0.01 0 0' 'run 1 pre no' "$tell"; right "$style: a small move and pre no" pe 0.5 1e-3
  two $style; more 'run 0' 'change_box all x final 0 7.6 remap units box' 'run 0' "$tell" # distance 0.76
  right "$style: change_box" pe 0.98 1e-11 ecoul 0 1e-20
  printf 'more\n\n2 atoms\n2 atom types\n0 8 xlo xhi\n0 6 ylo yhi\n-2 2 zlo zhi\n\nAtoms # sphere\n\n1 1 2.2 1 2.8 4.4 0\n2 2 0.2 1 6 5 0\n' >more.data
  two $style; more 'run 0' "read_data $work/more.data add append" 'run 0' "$tell" # radius 1.1 at 1.4 from 0.4 
  right "$style: read_data add append, larger than any before" pe 1 1e-12
  two $style; more 'run 0' 'replicate 2 1 1' 'run 0' "$tell"
  if [ $style = coulomb ]; then refused "$style: replicate" 'atom quantities'
  else right "$style: replicate" pe 1 1e-12; fi
done

# ---- slip of two disks: moved across by s, gamma = d s/|l| from state n ----
slide='run 0
group g id 2
displace_atoms g move 0 0.05 0'
gamma2=$(awk 'BEGIN { d = 0.8; s = 0.05; print 40 * (d * s) ^ 2 / (d * d + s * s) }') # E_t gamma^2 / 2
two coulomb; more "$slide" 'run 0' "$tell"; right 'displace_atoms: slip along the move' ecoul "$gamma2" 1e-7
for change in 'velocity all set 0 0 0' 'reset_atom_ids' 'displace_atoms all move 5.1 3.3 0' 'displace_atoms all move 4 3 0' 'change_box all boundary f p p' \
  'set atom 2 image 1 NULL NULL' 'set group all image 3 -2 NULL' 'set atom 2 mass 7' 'reset_timestep 1000' 'balance 1.1 shift xy 5 1.1' 'write_restart r.x' \
  'change_box all triclinic' 'region far block 6 8 5 6 -2 2
create_atoms 1 single 6 5 0' 'create_atoms 1 single 0.2 3 0'; do
  two coulomb; more "$slide" 'run 1' "$change" 'run 0' "$tell"; right "slip stays: ${change//$'\n'/; }" ecoul "$gamma2" 1e-5
  two coulomb; more "$slide" 'run 1' "$change" 'run 2' "$tell"; right "  and in a run" ecoul "$gamma2" 1e-4
  case $change in velocity* | set*) ;; *) continue ;; esac
  two coulomb; more "$slide" 'run 1' "$change" 'run 2 pre no' "$tell"; right "  and with pre no" ecoul "$gamma2" 1e-4
done
two coulomb; more "$slide" 'run 1' 'displace_atoms g move 0 2 0' 'run 0' "$tell"; right 'put away: no contact' pe 0 0
two coulomb; more "$slide" 'run 1' 'displace_atoms g move 0 2 0' 'run 0' 'displace_atoms g move -0.8 -1.25 0' 'run 0'
refused 'put onto another place' 'commands between runs have moved atom'
two coulomb; more "$slide" 'run 1' 'displace_atoms g move 0 2 0' 'run 1' 'displace_atoms g move 0 -0.3 0' 'run 1' "variable k loop 6" "label l" \
  'displace_atoms g move 0 -0.28333333333333333 0' 'run 1' 'next k' 'jump SELF l' "$tell"
right 'back in small steps: in contact again' evdwl "$(awk 'BEGIN { print 50 * (0.9 - sqrt(0.64 + 0.0025)) ^ 2 }')" 1e-7
two coulomb; more "$slide" 'run 1' 'delete_atoms group g compress no' 'create_atoms 2 single 2.8 3.05 0' 'set atom 2 diameter 0.8' 'run 0' "$tell"
right 'an id that is used again: no slip of the grain that is gone' ecoul 0 1e-20 pe "$(awk 'BEGIN { print 50 * (0.9 - sqrt(0.64 + 0.0025)) ^ 2 }')" 1e-7
two coulomb; more "$slide" 'run 1' 'write_dump all custom d.x id x y z ix iy' 'read_dump d.x 1 x y ix iy'
refused 'read_dump after a run' 'a dump holds neither rotations nor slip'
two coulomb; more "$slide" 'run 1' 'pair_style none' 'read_dump d.x 1 x y ix iy' 'pair_style granhom/coulomb' 'pair_coeff * * 100 80 0.5 0' 'run 0' "$tell"
right 'read_dump after all history was dropped' ecoul 0 1e-20
two normal; more 'run 0' 'dump d all atom 1 n.x' 'run 0' 'undump d' 'displace_atoms all move 1 1 0' 'read_dump n.x 0 x y box yes' 'run 0' "$tell"; right 'normal: read_dump' pe 0.5 1e-4
for command in "group g id 2
delete_atoms group g" 'create_atoms 1 single 6 5 0'; do
  words='use run 0 right after read_restart'
  [ "${command#create}" != "$command" ] && words='Cannot create_atoms after reading restart file'
  two coulomb 'create_atoms 1 single 6 1 0'; more "$slide" 'run 1' 'write_restart r.x'; right 'a restart file'
  again='newton off
read_restart r.x
pair_style granhom/coulomb
pair_coeff * * 100 80 0.5 0
neighbor 0.1 bin
thermo_modify norm no'
  printf '%s\n' "$again" "$command" 'run 0' >in.x
  refused "after read_restart: ${command//$'\n'/; }" "$words"
done
for command in 'reset_atom_ids sort yes' 'set group all image 2 1 NULL' 'velocity all set 0 0 0' 'run 0'; do
  printf '%s\n' "$again" "$command" 'run 0' "$tell" >in.x
  right "after read_restart: $command" ecoul "$gamma2" 1e-5
done

# ---- excavation from a packing with friction, and new ids: 150 disks ----
cat >head.in <<E2
variable out index out.txt
units lj
dimension 2
atom_style sphere
atom_modify map array
newton off
read_data $data
change_box all x scale 0.98 y scale 0.98 remap
pair_style granhom/coulomb
pair_coeff * * 1000 800 0.3 0
neighbor 0.02 bin
neigh_modify every 1 delay 0 check yes
timestep 1e-4
velocity all create 0.0001 4711 dist gaussian loop geom
fix 1 all nve/sphere disc
fix 2 all enforce2d
fix v all viscous 0.2
compute s all granhom/stress
compute c all granhom/contact/local
thermo_style custom step pe ecoul c_s[1] c_s[2] c_s[5] c_c[8] c_c[11]
thermo_modify norm no
run 1000
E2
tell2='print "ecoul $(ecoul)" append ${out} screen no
print "sxx $(c_s[1])" append ${out} screen no
print "slip $(c_c[8])" append ${out} screen no'
ids() { # on one rank or, with `ranks`, on two
  for compress in no yes; do # ecoul and sxx of the version that knew contacts by unchanged ids
    printf '%s\n' 'include head.in' 'group g id 10 20 30' "delete_atoms group g compress $compress" 'run 0' "$tell2" >in.x
    right "$1delete_atoms compress $compress" ecoul 0.0175428 1e-7 sxx -24.51654 1e-4
  done
  printf '%s\n' 'include head.in' 'group g id 10 20 30' 'delete_atoms group g compress no' 'run 100' 'run 100' "$tell2" >in.x
  right "$1and on"
  local ecoul sxx
  ecoul=$(value ecoul) sxx=$(value sxx)
  printf '%s\n' 'include head.in' 'group g id 10 20 30' 'delete_atoms group g compress yes' 'run 100' 'reset_atom_ids sort yes' 'run 100' "$tell2" >in.x
  right "$1and on with other ids" ecoul "$ecoul" 1e-7 sxx "$sxx" 1e-5
}
ids ''
# same NAME LINES LAST: what commands that leave the grains where they are leave of the slip, to round-off
same() {
  printf '%s\n' 'include head.in' "$2" "$3" "$tell2" >in.x
  right "$1" ecoul "$still" 1e-9 sxx "$stress" 1e-6
}
stays() { # on two ranks a selection
  local lasts=('run 0' 'run 100' 'run 100 pre no') moves=('$(lx) 0' '$(2*lx) 0' '$(-lx) $(ly)' '$(0.5*lx) $(0.9999*ly)')
  [ ${#ranks[@]} = 0 ] || lasts=('run 100' 'run 100 pre no') moves=('$(-lx) $(ly)')
  for last in "${lasts[@]}"; do
    printf '%s\n' 'include head.in' "$last" "$tell2" >in.x
    right "$1as it is: $last"
    still=$(value ecoul) stress=$(value sxx)
    same "$1images of half of the grains, $last" 'group od id 1:150:2
set group od image -3 4 NULL' "$last"
    if [ "$last" = 'run 100 pre no' ]; then # a list that is new in the first step
      same "$1renumbered, $last" 'reset_atom_ids sort yes
neigh_modify check no' "$last"
      same "$1images and renumbered, $last" 'set group all image -3 4 NULL
reset_atom_ids sort yes
neigh_modify check no' "$last"
      continue
    fi
    for move in "${moves[@]}"; do
      same "$1moved as a whole by $move, $last" "displace_atoms all move $move 0 units box" "$last"
    done
    same "$1one moved by a period, $last" 'group one id 24
displace_atoms one move $(lx) 0 0 units box' "$last"
  done
}
stays ''
printf '%s\n' 'include head.in' 'reset_atom_ids sort yes' 'run 100 pre no' >in.x
refused 'renumbered, pre no, with the list of before' 'cannot follow commands that add, remove, reorder or renumber'
# ---- what belongs to the pair style ----
for last in 'run 100' 'run 100 pre no' 'run 100 pre no every 10 "unfix granhom_history"'; do
  for command in 'unfix granhom_history' 'fix granhom_history all granhom/history'; do
    case $last in *every*) command='print x' ;; esac
    printf '%s\n' 'include head.in' "$command" "$last" >in.x
    refused "$command, $last" 'may not be removed or replaced'
  done
done
for pre in yes no; do
  printf '%s\n' 'include head.in' 'log lost.txt' 'pair_style granhom/normal' 'pair_style granhom/coulomb' 'pair_coeff * * 1000 800 0.3 0' 'log none' "run 100 pre $pre" "$tell2" >in.x
  right "the pair style given again, pre $pre: as without slip until then" ecoul 0.0097855 1e-7
  check 'and a warning' grep -q 'the slip of 339 contacts' lost.txt
done
# ---- rerun ----
cat >in.x <<E2
include head.in
dump d all custom 100 traj.x id type x y vx vy radius ix iy
dump_modify d sort id format float %.17g
run 200
undump d
rerun traj.x dump x y vx vy ix iy box yes
E2
refused 'rerun with friction' 'a dump holds neither the rotations nor the slip'
sed -e 's/granhom.coulomb/granhom\/normal/' -e 's/^pair_coeff.*/pair_coeff * * 1000/' -e '/^compute c/d' -e 's/ c_c.*//' head.in >normal.in
cat >in.x <<E2
include normal.in
variable p equal pe
fix t all print 100 "\$(v_p:%.12g)" file run.txt screen no title ""
dump d all custom 100 traj.x id type x y radius ix iy
dump_modify d sort id format float %.17g
run 200
unfix t
undump d
fix t all print 100 "\$(v_p:%.12g)" file rerun.txt screen no title ""
rerun traj.x dump x y ix iy box yes
E2
right 'rerun without friction'
check 'with the energies of the run' sh -c 'tail -n 2 run.txt >a; tail -n 2 rerun.txt >b; cmp a b && [ "$(sort -u a | grep -c .)" = 2 ]'

# ---- grains that fixes insert: never nearer than a little less than their diameter, as with LAMMPS's own style ----
pour() { # STYLE COEFFICIENTS NAME
  cat >in.x <<E2
units lj
dimension 2
atom_style sphere
boundary f fm p
newton off
comm_modify vel yes
region reg block 0 8 0 20 -0.5 0.5 units box
create_box 1 reg
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
pair_style $1
pair_coeff $2
timestep 0.002
fix 1 all nve/sphere disc
fix 2 all gravity 1.0 vector 0 -1 0
fix xw all wall/gran hooke/history 2000 NULL 50 NULL 0.5 0 xplane 0 8
fix yw all wall/gran hooke/history 2000 NULL 50 NULL 0.5 0 yplane 0 NULL
fix drag all viscous 0.3
region slab block 1 7 12 19 -0.5 0.5 units box
fix ins all pour 40 1 4767548 vol 0.4 10 diam one 1.0 region slab
fix 3 all enforce2d
thermo_modify lost ignore norm no
run 15000
compute d all pair/local dist
$local_input
compute n all reduce min c_d \${inputs}
variable m atom y
compute top all reduce max v_m
thermo_style custom step atoms c_top c_n
run 0
variable nearest equal c_n
variable top equal c_top
print "nearest \$(v_nearest)" append out.txt screen no
print "top \$(v_top)" append out.txt screen no
E2
  right "fix pour: ${1%% *}" nearest 0.999 0.002
}
pour 'gran/hooke/history 2000 1500 0 0 0.5 0' '* *' && gran=$(value top)
pour granhom/coulomb '* * 2000 1500 0.5 0'
check 'a heap of the same height within half a grain' near "$(value top)" "$gran" 0.5
pour 'gran/hooke/history 2000 1500 0 0 0 0' '* *' && gran=$(value top)
pour granhom/normal '* * 2000'
check 'without friction too' near "$(value top)" "$gran" 0.5
deposit() { # STYLE COEFFICIENTS: spheres of diameter 1, as fix deposit makes them, upon a small one
  cat >in.x <<E2
atom_style sphere
boundary p p f
newton off
comm_modify vel yes
region reg block 0 4 0 4 0 12
create_box 1 reg
create_atoms 1 single 1 1 0.05
set group all diameter 0.1
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
pair_style $1
pair_coeff $2
timestep 0.002
fix 1 all nve/sphere
fix 2 all gravity 1.0 vector 0 0 -1
fix zw all wall/gran hooke/history 2000 NULL 50 NULL 0 0 zplane 0 NULL
fix drag all viscous 0.5
region top block 0 4 0 4 8 11
fix ins all deposit 30 1 200 4711 region top near 1.0
thermo_modify lost ignore norm no
run 12000
group large id > 1
compute d all pair/local dist
$local_input
compute n all reduce min c_d \${inputs}
thermo_style custom step c_n
group small id 1
delete_atoms group small
run 0
print "nearest \$(c_n)" append out.txt screen no
E2
  right "fix deposit in 3d: ${1%% *}" nearest 0.996 0.004
}
deposit 'gran/hooke 2000 1500 0 0 0 0' '* *'
deposit granhom/normal '* * 2000'

# ---- hybrid ----
for style in 'hybrid granhom/coulomb' 'hybrid/overlay granhom/coulomb'; do
  sed -e "s,^pair_style.*,pair_style $style," -e 's,^pair_coeff,pair_coeff * * granhom/coulomb,' -e 's/coulomb \* \*/coulomb/' head.in >hybrid.in
  printf '%s\n' 'include hybrid.in' 'group g id 10 20 30' 'delete_atoms group g' 'run 0' "$tell2" >in.x
  right "$style" ecoul 0.0175428 1e-7 sxx -24.51654 1e-4
done
mixed() { # the third grain touches the second with overlap 0.1
  two coulomb 'create_atoms 2 single 3.5 3 0
set type 2 diameter 0.8'
  sed -i -e "s,^pair_style.*,pair_style $1," -e '/^pair_coeff/d' -e "/^neighbor/i $2" in.x
}
both='pair_coeff 1 1 granhom/coulomb 100 80 0.5 0\npair_coeff 1 2 granhom/coulomb 100 80 0.5 0\npair_coeff 2 2 granhom/normal 400'
mixed 'hybrid granhom/coulomb granhom/normal' "$both"; more "$slide" 'run 0' "$tell"
right 'hybrid of both: each pair by its style' ecoul "$gamma2" 1e-5 evdwl "$(awk 'BEGIN { print 50 * (0.9 - sqrt(0.6425)) ^ 2 + 200 * (0.8 - sqrt(0.4925)) ^ 2 }')" 1e-5
mixed 'hybrid/overlay granhom/coulomb granhom/normal' 'pair_coeff * * granhom/coulomb 100 80 0.5 0\npair_coeff 1 2 granhom/normal 10'; more 'run 0' "$tell"
right 'hybrid/overlay of both: the sum' evdwl 1.05 1e-12
for command in 'compute s all granhom/stress' 'compute s all granhom/contact/local' 'compute s all granhom/tangent' 'fix r all granhom/relax'; do
  mixed 'hybrid granhom/coulomb granhom/normal' "$both"; more "$command" 'run 0'
  refused "hybrid of both: $command" 'requires a single pair style of granhom, but pair_style hybrid has 1 granhom/normal and 1 granhom/coulomb'
done
mixed 'hybrid granhom/normal granhom/normal' 'pair_coeff * * granhom/normal 1 100\npair_coeff 2 2 granhom/normal 2 400'; more 'compute s all granhom/stress' 'run 0'
refused 'twice the same' 'has 2 granhom/normal and 0 granhom/coulomb'
mixed 'hybrid granhom/coulomb granhom/coulomb' 'pair_coeff * * granhom/coulomb 1 100 80 0.5 0\npair_coeff 2 2 granhom/coulomb 2 400 80 0.5 0'; more 'run 0'
refused 'friction twice' 'Only one pair style granhom/coulomb can be in use'
mixed 'hybrid zero 1' 'pair_coeff * * zero'; more 'compute s all granhom/stress' 'run 0'
refused 'none' 'requires one of the pair styles granhom/normal and granhom/coulomb'

# ---- programs that a script may not run ----
program() { # NAME LINE...
  printf '%s\n' "${@:2}" >in.x
  lammps in.x
  local code=$?
  if [ $code = 1 ] && grep -q 'start granhom lammps with --allow-shell' said.err && [ ! -e pwned ]; then ok "off: $1"; else not_ok "off: $1" "exit $code" "$(head -n 3 said.err)"; fi
  rm -f pwned
}
box='region r block 0 1 0 1 0 1
create_box 1 r
mass 1 1
pair_style zero 1
pair_coeff * *'
program 'shell' 'shell touch pwned'
program 'shell after clear' clear 'shell touch pwned'
program 'shell in if' 'if "1 == 1" then "shell touch pwned"'
program 'shell out of a variable' 'variable a string "shell touch pwned"' '${a}'
echo 'shell touch pwned' >in.more
program 'shell in an included file' 'include in.more'
program 'shell by a jump' 'jump in.more'
program 'shell that changes folders' 'shell cd /'
program 'python' 'python f source pwn.py'
program 'python in a variable' 'variable f python f' 'print "${f}"'
program 'pair_style python' "$box" 'pair_style python 1.0' 'pair_coeff * * py.Foo a' 'run 0'
program 'names of compressed dumps' "$box" 'dump 1 all atom 1 "x;touch pwned;.gz"' 'run 0'
program 'names of compressed data' 'read_data "x|touch pwned;.gz"'
program 'names with backquotes' 'read_data "`touch pwned`.gz"'
program 'models of KIM' 'kim init a metal'
printf 'shell touch made\n' >in.x
lammps in.x --allow-shell; check '--allow-shell: shell' test -e made
printf '%s\n' "$box" 'dump 1 all atom 1 x.gz' 'run 0' >in.x
lammps in.x; check 'compressed dumps with plain names' test -s x.gz
check 'the help names the option' sh -c "'$granhom' help lammps | grep -q -- '--allow-shell'"

# ---- two ranks ----
has MPI "two ranks" || exit $bad
if ! command -v mpirun >/dev/null || ! mpirun -n 2 true >said 2>said.err; then
  echo "skip - mpirun does not start here"
  exit $bad
fi
ranks=(mpirun -n 2)
ids 'two ranks: '
stays 'two ranks: '
two coulomb; more "$slide" 'run 1' 'delete_atoms group g compress no' 'create_atoms 2 single 2.8 3.05 0' 'set atom 2 diameter 0.8' 'run 0' "$tell"
right 'two ranks: an id that is used again' ecoul 0 1e-20 evdwl "$(awk 'BEGIN { print 50 * (0.9 - sqrt(0.64 + 0.0025)) ^ 2 }')" 1e-7
two coulomb; more "$slide" 'run 1' 'displace_atoms all move 2 0 0' 'set group all image 3 -2 NULL' 'run 2' "$tell"
right 'two ranks: moved as a whole, other images' ecoul "$gamma2" 1e-4
two normal; more 'run 0' 'set type 2 diameter 1.4' 'run 1 pre no'; lammps in.x
check 'two ranks: a radius beyond the cutoff' sh -c "[ $? != 0 ] && grep -q '^granhom: .*the radius 0.7 of atom 2 exceeds 0.4' said.err"
pour granhom/coulomb '* * 2000 1500 0.5 0'
exit $bad
