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
