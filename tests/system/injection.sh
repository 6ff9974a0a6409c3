#!/usr/bin/env bash
# Texts of a scene, of a study and of somebody else's folder: they reach pictures and reports as they are or are refused, and
# nothing in them is ever run. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. tests/shell.sh
begin
command -v gnuplot >/dev/null || { echo "skip - no gnuplot"; exit 0; }

# ---- inputs ----

nasty="'\"\`\$(touch PWNED-a)\`touch PWNED-b\`;|&#!touch PWNED-c \\n\\t\\{}@^_%g%s<b>~*"
quoted=${nasty//\'/\'\'} # between single quotes of YAML
cp "$root/tests/data/cases/packings/block150.data" p.data || exit 1
scene() { # NAME TITLE LENGTH FORCE STEP, each a YAML value
  cat >"$1" <<S
title: $2
units: {length: $3, force: $4}
packing: p.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor-cell, engine: native}
start: {balance: true}
mesh: {rectangle: {size: [10, 10], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: $5, increments: 2, displace: [{edge: top, y: 0.01}]}
S
}
study() { # NAME TITLE LENGTH FORCE
  cat >"$1" <<S
title: $2
units: {length: $3, force: $4}
rve:
  packing: p.data
  contact: {normal_stiffness: 50}
  micro: {boundary: taylor, engine: native}
  path: {legs: [{to: [0.99, 0, 0, 1], increments: 2}]}
vary: {contact.normal_stiffness: [50, 51]}
reference: {set: {contact.normal_stiffness: 52}}
plots: [P11]
order: contact.normal_stiffness
S
}
nothing_ran() { # NAME
  local found
  found=$(find . -name 'PWNED*' -print)
  if [ -z "$found" ]; then ok "$1: nothing ran"; else not_ok "$1: nothing ran" "$found"; fi
  find . -name 'PWNED*' -delete
}

# ---- gnuplot as it is started: what it reads is kept, the user's configuration are not read ----

mkdir bin home
real=$(command -v gnuplot)
cat >bin/gnuplot <<S
#!/bin/sh
echo "\$*" >>"$work/arguments"
cat >"$work/script" && cat "$work/script" >>"$work/scripts"
exec "$real" "\$@" <"$work/script"
S
chmod +x bin/gnuplot
printf '!touch %s/PWNED-rc\n' "$work" >home/.gnuplot
cp home/.gnuplot .gnuplot
run() { HOME=$work/home GNUPLOT_LIB=$work/home FIT_SCRIPT="touch $work/PWNED-fit" GNUTERM='dumb' PATH=$work/bin:$PATH "$granhom" "$@"; }

# ---- every mark that means something to a shell, to gnuplot, to HTML or to XML ----

scene ok.yaml "'$quoted'" "'m$quoted'" "'N$quoted'" "'s$quoted'"
check "a scene with every mark in its texts runs" "$granhom" run ok.yaml -o out --quiet
folder=$(printf 'x %s' "$nasty")
folder=${folder//\//_}
mv out "$folder"
check "its folder is called so, too" run plot "$folder"
commands=plot pictures="curves convergence"
has HDF5 "pictures of packings, report" && commands="plot report" pictures="mesh rve curves convergence"
for name in $pictures; do
  check "$name.png" sh -c 'head -c 4 "$1" | grep -q PNG' sh "$folder/$name.png"
done
if has HDF5; then
  check "report" "$granhom" report "$folder"
  check "the report has the title, escaped" grep -qF '@^_%g%s&lt;b&gt;~*</title>' "$folder/report.html"
fi
nothing_ran "run, plot, report"
sed -n 's/.*set title "\([\\0-7]*\)".*/\1/p' scripts | head -n 1 | sed 's/\\/\\0/g' >octal
if [ "$(printf '%b' "$(cat octal)")" = "$nasty" ]; then ok "gnuplot gets the title byte for byte"
else not_ok "gnuplot gets the title byte for byte" "$(printf '%b' "$(cat octal)")" "$nasty"; fi
sed -n 's/.*set xlabel "\([\\0-7]*\)".*/\1/p' scripts | head -n 1 | sed 's/\\/\\0/g' >octal
if [ "$(printf '%b' "$(cat octal)")" = "displacement of top in y (m$nasty)" ]; then ok "and the unit of the axis"
else not_ok "and the unit of the axis" "$(printf '%b' "$(cat octal)")"; fi
check "started with -d and a script" grep -qx -- '-d -' arguments
refuse_text() { # NAME PATTERN FILE: it is not in the file
  if grep -q -- "$2" "$3"; then not_ok "$1" "$(grep -- "$2" "$3" | head -n 3)"; else ok "$1"; fi
}
refuse_text "no script has a shell command, a macro or a name of a file" '[!`@]\|system\|set output\|PWNED\|\.png' scripts

study ok-study.yaml "'$quoted'" "'m$quoted'" "'N$quoted'"
check "a study with every mark in its texts" run study ok-study.yaml -o "so $folder"
for name in work-precision curves order; do
  check "$name.png" sh -c 'head -c 4 "$1" | grep -q PNG' sh "so $folder/$name.png"
done
nothing_ran "study"
refuse_text "nor have those of a study" '[!`@]\|system\|set output\|PWNED\|\.png' scripts

# a packing called so, found by a pattern: its name is a value of the study
mkdir packings
cp p.data "packings/$(printf '%s' "$nasty" | tr -d /)-1.data"
cp p.data packings/b.data
sed -e "s/^vary:.*/vary: {packing: ['packings\/*-1.data', packings\/b.data]}/" -e '/^order:/d' -e 's/^reference:.*/reference: {set: {packing: packings\/b.data}}/' ok-study.yaml >names.yaml
check "a packing called so" run study names.yaml -o so-names
nothing_ran "a packing called so"
cp p.data "packings/$(printf 'n\n!touch PWNED-n')-1.data"
run study names.yaml -o so-names2 >said.out 2>said.err
code=$?
if [ $code = 2 ] && grep -q 'holds a line break' said.err && [ ! -e so-names2 ]; then ok "refused: a packing with a line break in its name"
else not_ok "refused: a packing with a line break in its name" "exit $code" "$(cat said.err)"; fi
nothing_ran "a packing with a line break"
rm -rf packings

# ---- control characters ----

k=0
for mark in '\n!touch PWNED-n\n#' '\r!touch PWNED-r' '\t' '\e[31m' '\x7f' '\x01' '\N' '\L' '\u202e'; do
  for field in title length force step; do
    ugly="\"a$mark\"" k=$((k + 1))
    case $field in
    title) scene bad.yaml "$ugly" m N s ;;
    length) scene bad.yaml t "$ugly" N s ;;
    force) scene bad.yaml t m "$ugly" s ;;
    step) scene bad.yaml t m N "$ugly" ;;
    esac
    "$granhom" run bad.yaml -o bad$k --quiet >said.out 2>said.err
    code=$?
    line=1
    [ $field = length ] || [ $field = force ] && line=2
    [ $field = step ] && line=10
    if [ $code = 2 ] && grep -q "^granhom: bad.yaml:$line: .*holds .*, a text in one line is wanted" said.err && [ "$(wc -l <said.err)" = 1 ] && [ ! -e bad$k ]; then ok "refused: $mark in $field"
    else not_ok "refused: $mark in $field" "exit $code" "$(cat -v said.err)"; fi
  done
done
for field in title length force; do
  ugly='"a\n!touch PWNED-s\n#"'
  case $field in
  title) study bad.yaml "$ugly" m N ;;
  length) study bad.yaml t "$ugly" N ;;
  force) study bad.yaml t m "$ugly" ;;
  esac
  refused_by study "a line break in the $field of a study" "holds a line break" "$work/bad.yaml" -o so
done
study bad.yaml t m N
sed -i 's/^vary:.*/vary: {"a\\n!touch PWNED-k": [50, 51]}/; /^order/d' bad.yaml
refused_by study "a line break in a key of a study" "holds a line break" "$work/bad.yaml" -o so
nothing_ran "control characters"

# ---- somebody else's folder ----

scene ok.yaml title m N s
check "a harmless scene" "$granhom" run ok.yaml -o out --quiet
spoil() { # NAME SED: run.json changed; plot and report refuse
  local code
  rm -rf foreign && cp -r out foreign
  sed -i "$2" foreign/run.json
  for command in $commands; do
    run $command foreign >said.out 2>said.err
    code=$?
    if [ $code = 2 ] && grep -q '^granhom: foreign/run.json: .* a text in one line is wanted' said.err && [ -z "$(ls foreign | grep 'png\|html')" ]; then ok "$command refuses $1"
    else not_ok "$command refuses $1" "exit $code" "$(cat -v said.err)" "$(ls foreign)"; fi
  done
}
spoil "a line break in the title" 's/"title":.*/"title": "a\\n!touch PWNED-t\\n#",/'
spoil "a carriage return in the title" 's/"title":.*/"title": "a\\r!touch PWNED-t\\n#",/'
spoil "a line break in a unit" 's/"length":.*/"length": "a\\n!touch PWNED-u\\n#",/'
spoil "an escape in a unit" 's/"force":.*/"force": "a\\u001b[31m"/'
spoil "a line break in the driven set" 's/"set":.*/"set": "top\\n!touch PWNED-d\\n#",/'
rm -rf foreign && cp -r out foreign
sed -i 's/"title":.*/"title": "`touch PWNED-q` $(touch PWNED-p) \x27; !touch PWNED-e \\" system(\\"touch PWNED-y\\")",/' foreign/run.json
check "marks in a foreign title are drawn" run plot foreign
mv foreign "$(printf 'new\n!touch PWNED-nl\n#line')"
check "a folder with a line break in its name" run plot "$(printf 'new\n!touch PWNED-nl\n#line')"
nothing_ran "somebody else's folder"

# ---- gnuplot that is missing or fails ----

mkdir empty fails
cp -r out again
PATH=$work/empty "$granhom" plot again >said.out 2>said.err
code=$?
if [ $code = 1 ] && grep -q 'curves.png: gnuplot is not installed' said.err && [ ! -e again/curves.png ]; then ok "no gnuplot: said"
else not_ok "no gnuplot: said" "exit $code" "$(cat said.err)"; fi
printf '#!/bin/sh\necho "it has a bad day" >&2\nexit 3\n' >fails/gnuplot
chmod +x fails/gnuplot
PATH=$work/fails:$PATH "$granhom" plot again >said.out 2>said.err
code=$?
if [ $code = 1 ] && grep -q 'curves.png: gnuplot failed (status 3): it has a bad day' said.err && [ ! -e again/curves.png ]; then ok "gnuplot fails: said with its message"
else not_ok "gnuplot fails: said with its message" "exit $code" "$(cat said.err)"; fi
printf '#!/bin/sh\nhead -c 100 /dev/zero\n' >fails/gnuplot
PATH=$work/fails:$PATH "$granhom" plot again >said.out 2>said.err
code=$?
if [ $code = 1 ] && grep -q 'has not drawn a whole picture' said.err && [ ! -e again/curves.png ]; then ok "half a picture is none"
else not_ok "half a picture is none" "exit $code" "$(cat said.err)"; fi

# ---- the sources ----

if grep -nE '\b(popen|system) *\(' -r "$root/src" "$root/driver" --include=*.c --include=*.cpp >calls; then not_ok "no source starts a shell" "$(cat calls)"
else ok "no source starts a shell"; fi
exit $bad
