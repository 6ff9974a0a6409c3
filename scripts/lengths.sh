#!/bin/sh
# Lengths: no file of the repository above 500 lines, no function in C or C++ above 60. lengths.sh [FILE...]: prints those that are, exit
# status 1 then. Functions are told by their layout (clang-format): they start and end in the first column.
# SPDX-License-Identifier: GPL-2.0-or-later
set -eu
[ $# -gt 0 ] || set -- $(git ls-files '*.c' '*.h' '*.cpp' '*.sh' '*.py')
awk -v most_file=500 -v most_function=60 '
  function file_end() {
    if (lines > most_file) { printf "%s: %d lines, above %d\n", file, lines, most_file; found = 1 }
  }
  FNR == 1 { if (NR > 1) file_end(); file = FILENAME; start = open = 0; text = ""; code = file ~ /\.(c|h|cpp)$/ }
  { lines = FNR }
  !code { next }
  open && /^}/ {
    if (FNR - start + 1 > most_function) { printf "%s:%d: a function of %d lines, above %d\n", file, start, FNR - start + 1, most_function; found = 1 }
    open = start = 0; text = ""; next
  }
  open { next }
  /^[A-Za-z_]/ { start = FNR; text = "" }
  { text = text $0 }
  start && /\{$/ && text ~ /\(/ && text !~ /=/ && text !~ /^(struct|enum|union|typedef|namespace|class|extern "C")/ { open = 1 }
  /[;:}]$/ { text = ""; start = 0 }
  END { file_end(); exit found }' "$@"
