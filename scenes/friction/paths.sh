#!/bin/sh
# Paths of F for the friction experiments: paths.sh DIR. SPDX-License-Identifier: GPL-2.0-or-later
#   uniaxial-K-L.csv   compression along axis K up to L, increments of 0.001 (dissertation, 4.5.1)
#   shear-K-L.csv      biaxial compression by 0.01 in 10 increments, then simple shear along axis K up to L, in increments of
#                      0.002 for L = 1, else 0.001 (4.5.2)
#   cyclic-L.csv       the same compression, then shear along axis 1: 0, L, -L, 0 in 2000 increments (5.4.3)
set -eu
if [ $# -ne 1 ]; then
  echo "usage: paths.sh DIR" >&2
  exit 2
fi
mkdir -p "$1"

# path KIND AXIS AMPLITUDE >FILE
path() {
  awk -v kind="$1" -v axis="$2" -v most="$3" '
    function row(c1, c2, s) {
      printf "%d,%.17g,%.17g,%.17g,%.17g\n", step++, 1 - c1, axis == 1 ? s : 0, axis == 2 ? s : 0, 1 - c2
    }
    function shear(from, to, increments,   k) {
      for (k = 1; k <= increments; k++) row(0.01, 0.01, from + (to - from) * k / increments)
    }
    BEGIN {
      print "step,F11,F12,F21,F22"
      row(0, 0, 0)
      if (kind == "uniaxial") {
        n = int(most / 0.001 + 0.5)
        for (k = 1; k <= n; k++) row(axis == 1 ? most * k / n : 0, axis == 2 ? most * k / n : 0, 0)
        exit
      }
      for (k = 1; k <= 10; k++) row(0.001 * k, 0.001 * k, 0)
      if (kind == "shear") shear(0, most, int(most / (most < 1 ? 0.001 : 0.002) + 0.5))
      else {
        shear(0, most, 500)
        shear(most, -most, 1000)
        shear(-most, 0, 500)
      }
    }'
}
for axis in 1 2; do
  for most in 0.3 0.1; do path uniaxial $axis $most >"$1/uniaxial-$axis-$most.csv"; done
  for most in 1 0.2; do path shear $axis $most >"$1/shear-$axis-$most.csv"; done
done
for most in 0.5 0.05; do path cyclic 1 $most >"$1/cyclic-$most.csv"; done
