#!/bin/sh
# Times of one RVE update for each size, boundary condition and engine, of its linear system, then growth of packings: run.sh [BUILD].
# Wants a quiet machine; one core. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_ess_singleton_isolated=1
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
build=${1:-build}
cd "$(dirname "$0")/../.."
grep -m1 'model name' /proc/cpuinfo || true
one=
if command -v taskset >/dev/null 2>&1; then one="taskset -c 0"; fi
$one "$build/tests/bench/rve"
echo
$one "$build/tests/bench/solver"
echo
$one "$build/tests/bench/grow"
echo
tests/bench/farm.sh "$build"
