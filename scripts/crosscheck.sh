#!/bin/sh
# The tables and pictures of docs/reports/crosscheck.md, into the folder OUT (first argument): about ten minutes.
# SPDX-License-Identifier: GPL-2.0-or-later
set -eu
out=${1:-crosscheck-out}
granhom=${BUILD:-build}/granhom
scene=scenes/crosscheck
run() { # run NAME ARGUMENTS...
  name=$1
  shift
  echo "granhom crosscheck $* -o $out/$name"
  "$granhom" crosscheck "$@" --normal-stiffness 1000 --tolerance 1e-10 -o "$out/$name" 2>/dev/null | tee "$out/$name.txt"
  echo
}
mkdir -p "$out"
run smooth $scene/sand300.data --path $scene/compression.csv
run mu05 $scene/sand300.data --path $scene/compression.csv --tangential-stiffness 200 --friction-coefficient 0.5 --refine 5
run mu01 $scene/sand300.data --path $scene/compression.csv --tangential-stiffness 200 --friction-coefficient 0.1 --refine 5
run disks $scene/disks150.data --path $scene/compression10.csv --tangential-stiffness 200 --friction-coefficient 0.5 --refine 6 --increment-steps 200
