#!/bin/sh
# Runs a block of sand and draws it: demo.sh [BUILDDIR]. Called by `make demo`. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
granhom=${1:-build}/granhom
scene=scenes/block/p02_restricted.yaml
cd "$(dirname "$0")/.."
echo "A block of sand, 36 integration points with 150 grains each: half a minute to a minute. The scene is $scene."
mkdir -p demo
# one line per increment on the screen, all iterations in the log
{ code=0; "$granhom" run "$scene" -o demo || code=$?; echo "exit status $code"; } 2>&1 | tee demo/log.txt | grep -E '[0-9] done: |^[0-9].*s|^granhom: ' || true
if ! grep -q '^exit status 0$' demo/log.txt; then
  echo "granhom: the demo failed; the whole log is in demo/log.txt" >&2
  exit 1
fi
"$granhom" plot demo
cat <<E

Look at
  demo/mesh.png          the deformed block, coloured by its von Mises stress
  demo/rve.png           the grains of its most loaded integration point, and the forces between them
  demo/curves.png        force on the top and dilatancy over its displacement
  demo/convergence.png   residuals of the last increments
  demo/history.csv       numbers of each increment
  demo/results.xdmf      all of it, for ParaView
E
