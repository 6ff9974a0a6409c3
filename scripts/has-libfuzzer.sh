#!/bin/sh
# Whether clang can build for libFuzzer with its sanitizers. SPDX-License-Identifier: GPL-2.0-or-later
command -v clang >/dev/null 2>&1 && command -v clang++ >/dev/null 2>&1 || exit 1
out=$(mktemp) || exit 1
echo 'int LLVMFuzzerTestOneInput(const char *d, unsigned long n) { (void)d; return (int)(n & 0); }' |
  clang -x c -fsanitize=fuzzer,address,undefined - -o "$out" >/dev/null 2>&1
code=$?
rm -f "$out"
exit $code
