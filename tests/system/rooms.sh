#!/usr/bin/env bash
# Rooms of the code: no circle of calls between the files of a module nor between modules, and no module includes a header that is
# another's own (scripts/circles.sh; LAMMPS's styles are left out); no file and no function that is too long (scripts/lengths.sh).
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
build=${BUILD:-build}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

scripts/circles.sh "$build" >"$work/found"
say $(($? > 1)) "the symbols of the objects can be read"
[ -s "$work/found" ]
say $((! $?)) "no circle of calls, and no header of another module"
cat "$work/found"

# The script finds what it is for: two files that call each other, and a header of another module.
mkdir -p "$work/tree/scripts" "$work/tree/src/one" "$work/tree/src/two"
cp scripts/circles.sh "$work/tree/scripts"
cd "$work/tree" || exit 1
echo 'int b(void); int a(void); int a(void) { return b(); }' >src/one/a.c
echo 'int a(void); int c(void); int b(void); int b(void) { return a() + c(); }' >src/one/b.c
printf '#include "one/own.h"\nint c(void); int c(void) { return 1; }\n' >src/two/c.c
touch src/one/own.h
for f in one/a one/b two/c; do mkdir -p "build/src/${f%/*}" && ${CC:-gcc} -Isrc -c "src/$f.c" -o "build/src/$f.c.o"; done
scripts/circles.sh build >found
[ $? = 1 ] && grep -q '^circle of files: src/one/a.c, src/one/b.c: src/one/a.c -> src/one/b.c (b); src/one/b.c -> src/one/a.c (a)$' found
say $? "a circle of two files is found"
grep -q '^header of another module: src/two/c.c:1 includes one/own.h$' found && [ "$(wc -l <found)" = 2 ]
say $? "the header of another module is found, and nothing else"
echo 'int a(void); int c(void); int c(void) { return a(); }' >src/two/c.c
${CC:-gcc} -c src/two/c.c -o build/src/two/c.c.o
scripts/circles.sh build | grep -q '^circle of modules: one, two: one -> two (src/one/b.c: c); two -> one (src/two/c.c: a)$'
say $? "a circle of two modules is found"
cd - >/dev/null || exit 1

if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  scripts/lengths.sh >"$work/long"
  say $? "no file above 500 lines, no function above 60"
  cat "$work/long"
else
  echo "skip - no git work tree: which files belong to the repository is not known"
fi
body() { for k in $(seq "$1"); do echo "  x += $k;"; done; }
{ printf 'enum kind {\n  ONE,\n};\nstatic const int primes[] = {2,\n  3};\nint short_one(int x) {\n' && body 58 && printf '}\nint long_one(int x,\n             int y) {\n' && body 58 && echo '}'; } >"$work/long.c"
yes '#' | head -n 501 >"$work/long.sh"
[ "$(scripts/lengths.sh "$work/long.c" "$work/long.sh" | sed "s|$work/||")" = 'long.c:66: a function of 61 lines, above 60
long.sh: 501 lines, above 500' ]
say $? "a function of 61 lines and a file of 501 are found, one of 60 lines is not"
exit $failed
