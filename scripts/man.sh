#!/bin/sh
# The manual page, from a frame and from what the program's help states: man.sh GRANHOM FRAME. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
granhom=$1 frame=$2
# Lines of text as they are, in a form that troff leaves alone.
escape() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }
commands() { "$granhom" help | sed -n 's/^  \([a-z][a-z]*\)  *[^ ].*$/\1/p' | grep -vx help; }
describe() {
  for command in $(commands); do
    echo ".SS granhom $command"
    "$granhom" help "$command" | sed -n "1s/^granhom $command: //p" | escape
    echo .PP
    echo .nf
    "$granhom" help "$command" | sed 1,2d | escape
    echo .fi
  done
}
version=$("$granhom" --version | sed -n 's/^granhom //p')
sed "s/@VERSION@/$version/" "$frame" | while IFS= read -r line; do
  if [ "$line" = "@COMMANDS@" ]; then describe; else printf '%s\n' "$line"; fi
done
