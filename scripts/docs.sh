#!/bin/sh
# The pages of docs/reference: every block between `<!-- granhom help ... -->` and `<!-- end -->` is what that command prints.
# docs.sh GRANHOM [FOLDER]: FOLDER (docs/reference) is brought up to date. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
granhom=$1 folder=${2:-docs/reference}
# Help of commands is text; keys and columns are tables of Markdown.
block() {
  case $1 in
    keys* | columns*) "$granhom" help $1 ;;
    *) echo '```' && "$granhom" help $1 && echo '```' ;;
  esac
}
for page in "$folder"/*.md; do
  grep -q '^<!-- granhom help' "$page" || continue
  while IFS= read -r line; do
    case $line in
      '<!-- granhom help'*)
        inside=1 words=${line#'<!-- granhom help'} words=${words%'-->'}
        printf '%s\n' "$line" && block "$(echo $words)"
        ;;
      '<!-- end -->') inside=0 && printf '%s\n' "$line" ;;
      *) [ "${inside:-0}" = 1 ] || printf '%s\n' "$line" ;;
    esac
  done <"$page" >"$page.new"
  if cmp -s "$page" "$page.new"; then rm "$page.new"; else mv "$page.new" "$page"; fi
done
