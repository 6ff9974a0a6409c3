#!/bin/sh
# The pages of docs/reference: every block between `<!-- granhom help ... -->` and `<!-- end -->` is what that command prints. Options
# that an earlier command of the page has in the same words are only named. docs.sh GRANHOM [FOLDER]: FOLDER (docs/reference) is
# brought up to date. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
granhom=$1 folder=${2:-docs/reference}
seen=$(mktemp)
page=
trap 'rm -f "$seen" "$page.new"' EXIT

# An option is a line "  -..." with the indented lines behind it; $seen has those of earlier commands, one a line.
shorten() {
  awk -v command="$1" -v seen="$seen" '
    function finish() {
      if (entry == "") return
      if (entry in known) names[known[entry]] = names[known[entry]] (names[known[entry]] == "" ? "" : ", ") option
      else {
        text = entry
        gsub(/\001/, "\n", text)
        print text
        print command "\t" entry >>seen
      }
      entry = ""
    }
    function list() {
      finish()
      for (k = 1; k <= count; k++) {
        if (names[order[k]] != "") print "  as for granhom " order[k] ": " names[order[k]]
        names[order[k]] = ""
      }
    }
    BEGIN {
      FS = "\t"
      while ((getline line <seen) > 0) {
        split(line, part, "\t")
        known[part[2]] = part[1]
        if (!(part[1] in place)) { place[part[1]] = 1; order[++count] = part[1] }
      }
      close(seen)
    }
    /^  -/ {
      finish()
      entry = $0
      match($0, /--?[a-z][a-z-]*/)
      option = substr($0, RSTART, RLENGTH)
      if (match($0, /--[a-z][a-z-]*/)) option = substr($0, RSTART, RLENGTH)
      next
    }
    /^        / && entry != "" { entry = entry "\001" $0; next }
    { list(); print }
    END { list() }'
}
# Help of commands is text; keys and columns are lists in Markdown.
block() {
  text=$("$granhom" help $1) || exit 1
  case $1 in
    keys* | columns*) printf '%s\n' "$text" ;;
    *) echo '```' && printf '%s\n' "$text" | shorten "$1" && echo '```' ;;
  esac
}
for page in "$folder"/*.md; do
  grep -q '^<!-- granhom help' "$page" || continue
  : >"$seen"
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
