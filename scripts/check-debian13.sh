#!/usr/bin/env bash
# Builds and tests granhom in Debian 13 from another Debian: check-debian13.sh [ARGUMENTS OF make]; without any, `make check`.
#   scripts/check-debian13.sh demo plugin          make demo plugin in there
# A Debian 13 system is made by debootstrap in build/debian13 (DEBIAN13_ROOT: another folder; 3 GB, kept for the next run), the tracked
# files are copied to /granhom in it, and make runs there. Its mounts live in a mount namespace of this script alone: they are gone
# with it, however it ends.
# Needs: root, debootstrap (apt-get install debootstrap), and the network or a mirror of Debian (MIRROR=URL; default: the one of
# this system's package sources). SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
fail() { echo "granhom: $*" >&2; exit 1; }
what='a Debian 13 system to test in'
[ "$(id -u)" = 0 ] || fail "making $what needs root: sudo $0"
for program in debootstrap unshare chroot git; do
  command -v $program >/dev/null 2>&1 || fail "making $what needs $program: apt-get install debootstrap util-linux coreutils git"
done
unshare --mount true 2>/dev/null || fail "making $what needs the right to mount (CAP_SYS_ADMIN), which this container does not give"
root=${DEBIAN13_ROOT:-build/debian13}
mkdir -p "$root"
root=$(cd "$root" && pwd)

# Of this system's sources the first that is a mirror of Debian itself, not of its security updates.
mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 2>/dev/null | grep -m 1 '/debian/*$' || true)}
mirror=${mirror:-http://deb.debian.org/debian}
if [ ! -e "$root/made" ]; then
  echo "granhom: debootstrap of Debian 13 into $root"
  rm -rf "$root"
  debootstrap --variant=minbase trixie "$root" "$mirror" >"$root.log" 2>&1 || fail "debootstrap failed; the end of $root.log: $(tail -n 3 "$root.log")"
  touch "$root/made"
fi
# Proxies, time-outs and the like of this system, and its names of hosts.
apt-config dump | grep -E '^Acquire::(https?|ftp|Check-|Retries|ForceIPv)' >"$root/etc/apt/apt.conf.d/99host" || true
for file in resolv.conf hosts; do
  [ -e /etc/$file ] && cp -L /etc/$file "$root/etc/$file"
done

# The tracked files as they are in the work tree, with their times; objects of the last run stay.
mkdir -p "$root/granhom"
find "$root/granhom" -mindepth 1 -maxdepth 1 ! -name 'build*' -exec rm -rf {} +
git ls-files -z | while IFS= read -r -d '' file; do [ -e "$file" ] && printf '%s\0' "$file"; done |
  tar --create --null --files-from=- --file=- | tar --extract --file=- --directory="$root/granhom" --no-same-owner

[ $# -gt 0 ] || set -- check
# shellcheck disable=SC2016
exec unshare --mount --propagation private bash -c '
  set -eu
  root=$1
  shift
  mount -t proc proc "$root/proc"
  mount --rbind /dev "$root/dev"
  mount --rbind /sys "$root/sys" 2>/dev/null || true
  exec chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 ${TEST_TIMEOUT:+TEST_TIMEOUT="$TEST_TIMEOUT"} ${TEST_JOBS:+TEST_JOBS="$TEST_JOBS"} \
    bash -c "cd /granhom && scripts/install-packages.sh check && exec make \"\$@\"" make "$@"' check-debian13 "$root" "$@"
