#!/bin/sh
# Installs the Debian packages that granhom needs and that are missing; with `check`, those of the tests too; with `crosscheck`,
# LIGGGHTS, with `fuzz`, clang with libFuzzer, with `tidy` and `format`, clang's tools, which granhom can do without. With `missing`:
# installs nothing, and fails where a package for building is missing. Asks for root only when something is missing.
# SPDX-License-Identifier: GPL-2.0-or-later
set -eu
build="gcc g++ make pkg-config lammps liblammps-dev libsuitesparse-dev libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libyaml-dev libcjson-dev libcairo2-dev libxxhash-dev gnuplot-nox"
[ "${HDF5:-1}" = 0 ] && build=$(echo "$build" | sed 's/ libhdf5-openmpi-dev//')
[ "${MPI:-1}" = 0 ] && build=$(echo "$build" | sed 's/ openmpi-bin//') # LAMMPS's headers want mpi.h even so
check="libcmocka-dev python3-minimal python3-meshio python3-vtk9 python3-h5py valgrind"
fuzz="python3 clang libclang-rt-dev"
case ${CC:-} in *clang*) build="$build clang libclang-rt-dev" ;; esac
wanted=$build
[ "${1:-}" = check ] && wanted="$build $check"
[ "${1:-}" = crosscheck ] && wanted="$build liggghts"
[ "${1:-}" = fuzz ] && wanted="$build $fuzz"
[ "${1:-}" = tidy ] && wanted="$build $check clang-tidy"
[ "${1:-}" = format ] && wanted="clang-format"
# A system without dpkg has its own names; there the compiler reports what is missing.
[ "${1:-}" = missing ] && ! command -v dpkg-query >/dev/null 2>&1 && exit 0
missing=
for p in $wanted; do
  dpkg-query -W -f='${Status}' "$p" 2>/dev/null | grep -q 'ok installed' || missing="$missing $p"
done
[ -z "$missing" ] && exit 0
if [ "${1:-}" = missing ]; then
  echo "granhom: missing Debian packages:$missing. Install them with: make packages" >&2
  exit 1
fi
if ! command -v apt-get >/dev/null 2>&1; then
  echo "granhom: needs the Debian packages$missing, and there is no apt-get here: please install them" >&2
  exit 1
fi
root=
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null 2>&1 || { echo "granhom: run this as root once: apt-get install$missing" >&2; exit 1; }
  root=sudo
fi
echo "granhom: installing$missing"
$root apt-get update -qq
# shellcheck disable=SC2086
$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
