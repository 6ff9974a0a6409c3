#!/usr/bin/env bash
# A sample of `make faults`: allocations and calls on files that fail. SEED repeats one.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # ok, not_ok
if [ -n "${SANITIZED:-}" ] || ! /usr/bin/python3 -c 'import h5py' 2>/dev/null || ! "${BUILD:-build}/granhom" --version | grep -q 'HDF5 yes'; then
  echo "skip - failing calls (another allocator, or no h5py, or no HDF5)"
  exit 0
fi
seed=${SEED:-1} # fixed, so that a change of the sources is what changes the outcome
said=$(SAMPLE=6 SEED=$seed JOBS=1 ROWS="run:io:hard rve:own:hard pack:io:hard explain:lib:hard element:io:full report:io:hard study-ranks@1:own:hard" tests/faults/run.sh 2>&1)
sum=$(printf '%s\n' "$said" | tail -n 1)
if [ "${sum#* passed, }" = "0 failed" ] && [ "${sum%% *}" -ge 30 ]; then ok "failing allocations and calls on files, seed $seed: $sum"
else not_ok "failing allocations and calls on files, seed $seed" "$said"; fi
exit $bad
