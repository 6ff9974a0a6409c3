#!/usr/bin/env bash
# make install as packagers and programmers use it: what is installed, pkg-config, a foreign C program with the shared
# and the static library, LAMMPS's errors in it, symbols, headers in C and C++, the manual page, make uninstall.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # ok, not_ok, check
BUILD=${BUILD:-build}
[ -n "${SANITIZED:-}" ] && { echo "skip - a library with a sanitizer is not for installing"; exit 0; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
root=$(pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# --- make install ---
prefix=$work/prefix
check "make install with PREFIX" make -s install BUILD="$BUILD" PREFIX="$prefix"
check "make install with DESTDIR" make -s install BUILD="$BUILD" PREFIX=/opt/granhom DESTDIR="$work/stage"
cd "$work" || exit 1
version=$("$prefix/bin/granhom" --version | sed -n 's/^granhom //p')
export PKG_CONFIG_PATH=$prefix/lib/pkgconfig LD_LIBRARY_PATH=$prefix/lib
(cd prefix && find . ! -type d | sort) >files
(cd stage/opt/granhom && find . ! -type d | sort) >staged
check "both install the same files" diff files staged
for file in bin/granhom lib/libgranhom.a lib/libgranhom.so "lib/libgranhom.so.$version" lib/pkgconfig/granhom.pc \
  lib/libgranhom-rve.so "lib/libgranhom-rve.so.$version" lib/pkgconfig/granhom-rve.pc lib/granhom/granhom-lammps.so \
  include/granhom/granhom.h include/granhom/control.h share/man/man1/granhom.1; do
  check "$file is installed" test -s "prefix/$file"
done
check "every public header is installed" diff <(cd "$root/include/granhom" && ls) <(ls prefix/include/granhom)
check "DESTDIR is no part of the installed prefix" grep -qx 'prefix=/opt/granhom' stage/opt/granhom/lib/pkgconfig/granhom.pc
check "DESTDIR is named nowhere" test -z "$(grep -rIl "$work" stage)"
check "pkg-config knows the version" test "$(pkg-config --modversion granhom)" = "$version"
check "the library's name has its major version" test \
  "$(readelf -d prefix/lib/libgranhom.so | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')" = "libgranhom.so.${version%%.*}"
check "the name at run time leads to the library" test "$(readlink -f "prefix/lib/libgranhom.so.${version%%.*}")" = \
  "$(readlink -f "prefix/lib/libgranhom.so.$version")"

# --- headers on their own ---
for header in prefix/include/granhom/*.h; do
  name=granhom/$(basename "$header")
  check "$name alone in C" gcc -std=c17 -Wall -Wextra -Wpedantic -Werror -Iprefix/include -x c -c -o /dev/null - <<<"#include <$name>"
  check "$name alone in C++" g++ -std=c++17 -Wall -Wextra -Werror -Iprefix/include -x c++ -c -o /dev/null - <<<"#include <$name>"
done
cat >cpp.cpp <<'END'
#include <granhom/granhom.h>
int main() {
  gh_context *ctx;
  if (gh_context_create(&ctx) != GH_OK) return 1;
  gh_packing *packing;
  gh_status status = gh_packing_read(ctx, "none.data", &packing);
  std::printf("%d %s\n", gh_exit_status(status), gh_message(ctx));
  gh_context_destroy(&ctx);
}
END
sed -i '1i #include <cstdio>' cpp.cpp
read -ra cflags <<<"$(pkg-config --cflags granhom)"
read -ra libs <<<"$(pkg-config --libs granhom)"
read -ra static_libs <<<"$(pkg-config --static --libs granhom | sed 's/-lgranhom/-l:libgranhom.a/')"
check "a C++ program" g++ -std=c++17 -Wall -Wextra -Werror cpp.cpp "${cflags[@]}" "${libs[@]}" -o cpp
check "gets messages" grep -q '^2 none.data: ' <(./cpp)

# --- the example of docs/reference/library.md ---
cat >path.csv <<'END'
step,F11,F12,F21,F22
0,1,0,0,1
1,0.9995,0.0002,0,0.9998
2,0.999,0.0004,0,0.9996
3,0.9985,0.0006,0,0.9994
END
sand=$root/scenes/block/sand150.data
prefix/bin/granhom rve "$sand" --normal-stiffness 50 --path path.csv --tangent tangent.csv -o rve.csv 2>/dev/null
paste -d, <(cut -d, -f1,6-9 rve.csv) <(cut -d, -f2- tangent.csv) >expected.csv
cp -r "$root/docs/examples/library" example
check "its Makefile" make -s -C example CFLAGS="-O2 -Wall -Wextra -Wpedantic -Werror"
check "shared library" ./example/material "$sand" path.csv
./example/material "$sand" path.csv >shared.csv
check "P and A are those of granhom rve, to the last digit" diff expected.csv <(head -n 5 shared.csv)
check "the steps after the restored state too" diff <(tail -n 2 expected.csv) <(tail -n 2 shared.csv)
check "the native engine" awk -F, 'NR == FNR { for (k = 1; k <= NF; k++) a[FNR, k] = $k; next }
  FNR > 1 && FNR < 6 { for (k = 1; k <= NF; k++) if (($k - a[FNR, k]) ^ 2 > 1e-16 * (1 + $k ^ 2)) exit 1; rows++ } END { if (rows != 4) exit 1 }' \
  expected.csv <(./example/material "$sand" path.csv native)
check "static library" gcc -std=c17 -Wall -Wextra -Werror example/material.c "${cflags[@]}" "${static_libs[@]}" -o static
check "needs no shared one" test -z "$(ldd static | grep granhom)"
check "and gives the same" diff shared.csv <(LD_LIBRARY_PATH='' ./static "$sand" path.csv)

# --- LAMMPS's errors arrive as messages ---
cat >error.c <<'END'
#include <granhom/granhom.h>
int main(void) {
  gh_context *ctx;
  void *lmp;
  if (gh_context_create(&ctx) != GH_OK) return 1;
  gh_status status = gh_lmp_open(ctx, &lmp);
  if (status == GH_OK) status = gh_lmp_command(ctx, lmp, "pair_style nonsense");
  printf("%s\n", gh_message(ctx));
  gh_lmp_close(&lmp);
  gh_context_destroy(&ctx);
  return status == GH_ENGINE ? 0 : 1;
}
END
# told NAME WORDS PROGRAM: it lives on after LAMMPS's error, and its message has the words
told() {
  local said code
  said=$("$3" 2>&1)
  code=$?
  if [ $code = 0 ] && grep -qF -e "$2" <<<"$said"; then ok "$1"; else not_ok "$1" "exit $code" "$said"; fi
}
check "a program that lets LAMMPS fail" gcc error.c "${cflags[@]}" "${libs[@]}" -o error
told "LAMMPS's error with the shared library" "Unrecognized pair style 'nonsense'" ./error
check "statically" gcc error.c "${cflags[@]}" "${static_libs[@]}" -o error_static
told "LAMMPS's error with the static library" "Unrecognized pair style 'nonsense'" ./error_static
check "together with LAMMPS" gcc error.c "${cflags[@]}" "${libs[@]}" -Wl,--no-as-needed -llammps -o error_with
told "LAMMPS's error in a program that links LAMMPS too" "Unrecognized pair style 'nonsense'" ./error_with
check "LAMMPS first" gcc error.c "${cflags[@]}" -Wl,--no-as-needed -llammps "${libs[@]}" -o error_after
told "in the other order" "Unrecognized pair style 'nonsense'" ./error_after
cat >error.py <<'END'
import ctypes, sys
gh = ctypes.CDLL(sys.argv[1])
ctx, lmp = ctypes.c_void_p(), ctypes.c_void_p()
gh.gh_message.restype = ctypes.c_char_p
assert gh.gh_context_create(ctypes.byref(ctx)) == 0
status = gh.gh_lmp_open(ctx, ctypes.byref(lmp))
if status == 0:
    status = gh.gh_lmp_command(ctx, lmp, b"pair_style nonsense")
print(gh.gh_message(ctx).decode())
sys.exit(0 if status else 1)
END
python_error() { /usr/bin/python3 error.py "prefix/lib/libgranhom.so.${version%%.*}"; }
told "LAMMPS's error in Python, which loads the library itself" "Unrecognized pair style 'nonsense'" python_error

# --- the manual page ---
sed 's/\\-/-/g' prefix/share/man/man1/granhom.1 >manual
"$prefix/bin/granhom" help | sed -n 's/^  \([a-z][a-z]*\)  *[^ ].*/\1/p' | grep -vx help >commands
check "there are commands" test "$(wc -l <commands)" -ge 6
while read -r command; do
  check "granhom $command has its section" grep -qx ".SS granhom $command" manual
  "$prefix/bin/granhom" help "$command" | grep -oE -- '--[a-z][a-z-]*' | sort -u >options
  sed -n "/^\.SS granhom $command\$/,/^\.S/p" manual | sed 1d | grep -oE -- '--[a-z][a-z-]*' | sort -u >in_manual
  check "with the options of its help" diff options in_manual
done <commands
if command -v groff >/dev/null 2>&1; then
  check "the page is well formed" test -z "$(groff -man -Tutf8 -ww -z prefix/share/man/man1/granhom.1 2>&1)"
else
  echo "skip - no groff to look at the page"
fi

# --- make uninstall ---
cd "$root" || exit 1
touch "$prefix/lib/other"
check "make uninstall" make -s uninstall BUILD="$BUILD" PREFIX="$prefix"
check "leaves what is not granhom's, and nothing else" test "$(cd "$prefix" && find . ! -type d)" = ./lib/other
check "make uninstall with DESTDIR" make -s uninstall BUILD="$BUILD" PREFIX=/opt/granhom DESTDIR="$work/stage"
check "leaves nothing" test -z "$(find "$work/stage" ! -type d)"

exit $bad
