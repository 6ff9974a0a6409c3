# What the scripts of tests/system share: one line per check, as tests/run.sh counts them. To be sourced; `bad` is 1 after a
# failure. SPDX-License-Identifier: GPL-2.0-or-later
# shellcheck shell=bash disable=SC2034
bad=0

ok() { echo "ok - $1"; }
not_ok() {
  echo "not ok - $1"
  shift
  [ $# -gt 0 ] && printf '  %s\n' "$@"
  bad=1
}
# check NAME COMMAND...: the command succeeds
check() {
  local name=$1 said
  shift
  if said=$("$@" 2>&1); then ok "$name"; else not_ok "$name" "$*" "$said"; fi
}
# say STATUS NAME: the same for a command that has been; the file `err` or `said.err` holds more
say() {
  local file
  if [ "$1" = 0 ]; then
    ok "$2"
    return
  fi
  not_ok "$2"
  for file in err said.err; do [ -s $file ] && sed 's/^/#   /' $file; done
}
# begin [memory]: BUILD, granhom and root with their whole names, and an empty folder `work` to be in (where there is one, in
# memory), which goes at the end; mpirun works in containers, too
begin() {
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 # containers with one core
  export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe # the same for Open MPI 5
  export OMPI_MCA_btl=^tcp,ofi,openib OMPI_MCA_pml=ob1 # and without a network
  BUILD=$(cd "${BUILD:-build}" && pwd) || exit 1
  root=$(pwd)
  granhom=$BUILD/granhom
  work=$( { [ "${1:-}" = memory ] && [ -w /dev/shm ] && mktemp -d -p /dev/shm; } || mktemp -d) && cd "$work" || exit 1
  trap 'rm -rf "$work"' EXIT
}
# has MPI, has HDF5, after begin: the program is built with it; has WHAT NAME: where it is not, NAME is skipped, which is printed
has() {
  "$granhom" --version | grep -q "^$1 yes" && return
  [ $# -gt 1 ] && echo "skip - $2 (no $1)"
  return 1
}
# refused_by COMMAND NAME WORDS ARGUMENTS...: granhom COMMAND ARGUMENTS in the empty folder `clean`: exit 2, WORDS, nothing written
refused_by() {
  local command=$1 name=$2 words=$3 code
  shift 3
  mkdir -p clean
  (cd clean && "$granhom" "$command" "$@" >../said.out 2>../said.err)
  code=$?
  if [ $code = 2 ] && grep -qF -- "$words" said.err && [ ! -s said.out ] && [ -z "$(ls -A clean)" ]; then ok "refused: $name"
  else not_ok "refused: $name" "exit $code, files: $(ls -A clean)" "$(head -n 5 said.err)" "wanted: $words"; fi
  rm -rf clean
}
