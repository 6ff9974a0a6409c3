#!/usr/bin/env bash
# The installed libraries: what each needs and exports, a C program on each, and the LAMMPS engine, which is loaded when it is
# asked for and no sooner, from wherever granhom lies. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # ok, not_ok, check, begin
[ -n "${SANITIZED:-}" ] && { echo "skip - a library with a sanitizer is not for installing"; exit 0; }
begin
check "make install" make -s -C "$root" install BUILD="$BUILD" PREFIX="$work/prefix"
version=$("$granhom" --version | sed -n 's/^granhom //p')
export PKG_CONFIG_PATH=$work/prefix/lib/pkgconfig LD_LIBRARY_PATH=$work/prefix/lib
sand=$root/scenes/block/sand150.data
lib=$work/prefix/lib

# --- what they need ---
needed() { readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'; }
others() { needed "$1" | grep -vE '^(lib(amd|cholmod|klu|umfpack|suitesparseconfig|m|c)|ld-linux[^.]*)\.so'; }
check "libgranhom-rve needs SuiteSparse, libc and libm alone" test -z "$(others "$lib/libgranhom-rve.so")"
check "it loads no MPI, HDF5, YAML, cairo or LAMMPS" test -z "$(ldd "$lib/libgranhom-rve.so" | grep -E 'mpi|hdf5|yaml|cjson|cairo|lammps|python|xxhash|stdc')"
check "libgranhom is not linked to LAMMPS" test -z "$(ldd "$lib/libgranhom.so" | grep -E 'lammps|python|stdc')"
check "the program is not linked to LAMMPS" test -z "$(ldd "$work/prefix/bin/granhom" | grep -E 'lammps|python|stdc')"
for name in granhom granhom-rve; do
  check "lib$name has its major version" test "$(readelf -d "$lib/lib$name.so" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')" = "lib$name.so.${version%%.*}"
  check "pkg-config knows $name" test "$(pkg-config --modversion $name)" = "$version"
done

# --- what they export: the functions of the headers ---
exported() { nm -D --defined-only "$1" | awk '{ print $3 }' | LC_ALL=C sort -u; }
cat prefix/include/granhom/*.h | gcc -fpreprocessed -dD -E -P -x c - 2>/dev/null | grep -vE 'static inline|^typedef' |
  grep -oE '\bgh_[A-Za-z0-9_]+\(' | tr -d '(' | LC_ALL=C sort -u >words
grep -hoE 'static inline [^(]*gh_[A-Za-z0-9_]+\(' prefix/include/granhom/*.h | grep -oE 'gh_[A-Za-z0-9_]+' | LC_ALL=C sort -u >inline
{ LC_ALL=C comm -23 words inline; grep -hoE '^GH_API extern .*\bgh_[A-Za-z0-9_]+' prefix/include/granhom/*.h | grep -oE 'gh_[A-Za-z0-9_]+$'; } | LC_ALL=C sort -u >headers
exported "$lib/libgranhom.so" >full
exported "$lib/libgranhom-rve.so" >rve
check "the headers declare functions" test "$(wc -l <headers)" -gt 250
check "libgranhom exports what the headers declare, and no more" diff headers full
check "all of libgranhom-rve is in libgranhom, too" test -z "$(LC_ALL=C comm -23 rve full)"
for name in gh_rve_evaluate gh_packing_read gh_packing_grow gh_control_solve gh_engine_create gh_lmp_open gh_message; do
  check "libgranhom-rve has $name" grep -qx $name rve
done
for name in gh_h5_open gh_yaml_read gh_farm_create gh_macro_solve gh_scene_read; do
  grep -qx $name rve && not_ok "libgranhom-rve has no $name" || ok "libgranhom-rve has no $name"
done
exported "$lib/granhom/granhom-lammps.so" | c++filt | sed 's/(.*//' | sort -u | grep -vx lammpsplugin_init >module
# a LAMMPS with exceptions keeps its own Error, of which the module may have copies of what its header defines
[ -e /usr/include/lammps/exceptions.h ] && sed -i '/^LAMMPS_NS::Error::/d' module
{
  printf '%s\n' gh_lammps_linked LAMMPS_NS::{LAMMPS::post_create,Input::execute_command,Python::init}
  [ -e /usr/include/lammps/exceptions.h ] || printf 'LAMMPS_NS::Error::%s\n' _all _one all done one universe_all universe_one
} | sort >wanted
check "the module exports its table and what it replaces" diff wanted module

# --- a C program on each ---
cat >path.csv <<'END'
step,F11,F12,F21,F22
0,1,0,0,1
1,0.9995,0.0002,0,0.9998
2,0.999,0.0004,0,0.9996
3,0.9985,0.0006,0,0.9994
END
"$granhom" rve "$sand" --normal-stiffness 50 --path path.csv --tangent tangent.csv -o rve.csv 2>/dev/null
paste -d, <(cut -d, -f1,6-9 rve.csv) <(cut -d, -f2- tangent.csv) >lammps.csv
"$granhom" rve "$sand" --normal-stiffness 50 --engine native --path path.csv --tangent tangent.csv -o rve.csv 2>/dev/null
paste -d, <(cut -d, -f1,6-9 rve.csv) <(cut -d, -f2- tangent.csv) >native.csv
for name in granhom granhom-rve; do
  mkdir "$name" && cp "$root"/docs/examples/library/{Makefile,material.c} "$name"
  check "the example on $name" make -s -C "$name" GRANHOM=$name CFLAGS="-O2 -Wall -Wextra -Wpedantic -Werror"
  for engine in native lammps; do
    "$name/material" "$sand" path.csv $engine >said 2>err
    check "$name, $engine engine: P and A are those of granhom rve, to the last digit" diff $engine.csv <(head -n 5 said)
  done
  LD_DEBUG=files "$name/material" "$sand" path.csv native >said 2>err
  check "$name: the native engine loads no LAMMPS" test -z "$(grep -E 'calling init.*(liblammps|granhom-lammps)' err)"
done
check "the example on libgranhom-rve is linked to one library of granhom" test "$(ldd granhom-rve/material | grep -c granhom)" = 1
check "and loads no MPI" test -z "$(ldd granhom-rve/material | grep -E 'mpi|hdf5|cairo')"

# --- a program that loads a library itself, in whatever order ---
cat >load.py <<'END'
import ctypes, os, sys
libraries = [ctypes.CDLL(name, mode=os.RTLD_GLOBAL if "lammps" in name else 0) for name in sys.argv[1:]]
gh = libraries[["granhom" in name for name in sys.argv[1:]].index(True)]
ctx, lmp = ctypes.c_void_p(), ctypes.c_void_p()
gh.gh_message.restype = ctypes.c_char_p
assert gh.gh_context_create(ctypes.byref(ctx)) == 0
assert gh.gh_lmp_open(ctx, ctypes.byref(lmp)) or gh.gh_lmp_command(ctx, lmp, b"pair_style nonsense")
print(gh.gh_message(ctx).decode(), flush=True)
if len(libraries) == 2: # an instance of the program's own ends it, as ever
    lammps = libraries[1 - libraries.index(gh)]
    lammps.lammps_open_no_mpi.restype = ctypes.c_void_p
    words = (ctypes.c_char_p * 5)(b"own", b"-log", b"none", b"-screen", b"own.screen")
    own = ctypes.c_void_p(lammps.lammps_open_no_mpi(5, words, None))
    lammps.lammps_command(own, b"pair_style mine")
    print("still there" if not lammps.lammps_config_has_exceptions() else "by its own exception")
    sys.exit(1 if not lammps.lammps_config_has_exceptions() else 7)
END
# loads_in_order NAME STATUS LIBRARIES...
loads_in_order() {
  local name=$1 status=$2 code
  shift 2
  /usr/bin/python3 load.py "$@" >said 2>err
  code=$?
  grep -q "Unrecognized pair style 'nonsense'" said
  say $? "LAMMPS's error is a message in Python, which loads $name"
  [ "$status" = 0 ] && [ $code != 0 ] && not_ok "and ends well" "exit $code"
  if [ "$status" != 0 ] && { [ $code = 0 ] || grep -q 'still there' said; }; then not_ok "that of its own instance is LAMMPS's" "exit $code"; fi
}
loads_in_order "libgranhom" 0 "$lib/libgranhom.so"
loads_in_order "libgranhom-rve" 0 "$lib/libgranhom-rve.so"
loads_in_order "LAMMPS before" 1 liblammps.so.0 "$lib/libgranhom.so"
loads_in_order "LAMMPS after" 1 "$lib/libgranhom.so" liblammps.so.0
grep -q "Unrecognized pair style 'mine'" own.screen
say $? "errors of the program's own instances stay LAMMPS's"

# --- the engine is loaded when it is asked for, and found from where granhom lies ---
loads() { LD_DEBUG=files "$@" 2>&1 >/dev/null | grep -cE 'calling init.*(liblammps|libpython)'; }
scene=$root/scenes/block/p01_taylor.yaml
check "--version loads no LAMMPS" test "$(loads "$granhom" --version)" = 0
check "run --explain loads none" test "$(loads "$granhom" run "$scene" --explain)" = 0
check "the native engine loads none" test "$(loads "$granhom" rve "$sand" --normal-stiffness 50 --engine native --path path.csv -o out.csv)" = 0
check "the LAMMPS engine does" test "$(loads "$granhom" rve "$sand" --normal-stiffness 50 --path path.csv -o out.csv)" -ge 1
lammps=$(sed -n 's/^LAMMPS //p' <<<"$("$granhom" --version)")
check "--version names the LAMMPS of the module" test "$lammps" -ge 20210929
mkdir elsewhere && cp "$BUILD/granhom" elsewhere/granhom
# fails NAME STATUS WORDS COMMAND...
fails() {
  local name=$1 status=$2 words=$3 code
  shift 3
  "$@" >said 2>err
  code=$?
  [ $code = "$status" ] && grep -qF -e "$words" err && [ "$(grep -c ^granhom: err)" = 1 ]
  say $? "$name"
}
rve() { ./elsewhere/granhom rve "$sand" --normal-stiffness 50 --path path.csv -o none.csv "$@"; }
fails "without the module: exit 1, the places are named" 1 "$work/elsewhere/granhom-lammps.so" rve
fails "granhom lammps without it" 1 "the LAMMPS engine cannot be loaded" ./elsewhere/granhom lammps -in none
check "--version states so" grep -q '^LAMMPS cannot be used' <(./elsewhere/granhom --version)
check "the native engine works without it" rve --engine native
echo nonsense >elsewhere/granhom-lammps.so
fails "a module that is none" 1 "$work/elsewhere/granhom-lammps.so" rve
cp "$lib/libgranhom-rve.so" elsewhere/granhom-lammps.so
fails "another library in its place" 1 "is no module of granhom" rve
printf 'const char *build(void) { return "other"; }\nconst char *(*const gh_lammps_linked)(void) = build;\n' |
  gcc -shared -fPIC -x c - -o elsewhere/granhom-lammps.so
fails "the module of another build" 1 "is of another build of granhom (other, not " rve
rm elsewhere/granhom-lammps.so && mkdir elsewhere/bin && mv elsewhere/granhom elsewhere/bin && cp -r prefix/lib elsewhere/lib
ln -s elsewhere/bin/granhom by_link
check "from bin/ to lib/granhom, through a link" ./by_link rve "$sand" --normal-stiffness 50 --path path.csv -o out.csv
check "by PATH" env PATH="$work/elsewhere/bin:$PATH" granhom rve "$sand" --normal-stiffness 50 --path path.csv -o out.csv

# --- debug builds: messages say where they come from ---
cat >debug.c <<'END'
#include "granhom/base.h"
int main(void) {
  gh_context *ctx;
  if (gh_context_create(&ctx) != GH_OK) return 1;
  gh_status status = gh_fail(ctx, GH_INPUT, "row %d is bad", 7);
  puts(gh_message(ctx));
  gh_context_destroy(&ctx);
  return gh_exit_status(status);
}
END
for flag in -DGH_DEBUG -DGH_NONE; do
  gcc -std=c17 -D_XOPEN_SOURCE=700 $flag -Wall -Wextra -Wpedantic -Werror -I"$root/include" debug.c "$root/src/base/context.c" -o debug && ./debug >>places
done
check "a debug build names file, line and function; others do not" diff <(printf 'row 7 is bad [debug.c:5 main]\nrow 7 is bad\n') places
for words in DEBUG=1 OPT=-O0; do
  check "make $words is a debug build" grep -q -- '-O0 .*-DGH_DEBUG' <(make -s -n -C "$root" BUILD="$work/none" $words 2>/dev/null)
done

exit $bad
