#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
#
# Words of the field: scripts/words.sh [FILE...]. Lists private words where the field has a term of its own, in comments and string
# literals of the C and C++ sources, and in all text of scripts, tests, documents and scenes (of FILE alone, where one is given). One
# finding a line on standard output, `file:line: "words found": term of the field`; exit status 1 when there is one, 2 for a failure.
# TERMS is the glossary: a new private word gets a line there. ALLOWED holds what stays.
set -u
cd "$(dirname "$0")/.." || exit 2
exec /usr/bin/python3 - "$@" <<'PYTHON'
import re
import subprocess
import sys

# Regular expression of whole words (a space is any white space, also across lines of a comment), and the term to use.
TERMS = [
    (r"(is|are|was|were|been|be) (also |then |not |still )?told(?! (from|apart|by))", "is reported, printed, logged"),
    (r"tells(?!.{0,40} apart)|says", "states, reports"),
    (r"kept slips?|slips? (is|are|was|were) kept|keep(s|ing)? (the |its |their )?slips?", "intermediate history commit, committed mid-increment"),
    (r"(go|goes|going|gone|went|runs?|running) (round )?in (a )?circles?", "limit cycle of the relaxation"),
    (r"taken as (it|they) (is|are|was|were)|tak(es?|ing) (a|the|its) packings? as (it|they) (is|are|was|were)", "accepted unconverged"),
    (r"polish(ed|es|ing)?", "Newton-finished, Newton finish"),
    (r"jumps? of (the |a |its )?packings?|packings? (that )?jump(s|ed)?", "instability (stress discontinuity, snap-through)"),
    (r"(beyond|past|behind|below|before) (the|a|its|their) jumps?", "post-instability"),
    (r"pass(es|ed|ing)? ([a-z]+ )?jumps?|steps? beyond jumps|(free in|with|no|few|many) jumps?", "instability, to step over an instability"),
    (r"(the|at|from) begin(?!ning)", "start"),
    (r"at hand", "current"),
    (r"(go|goes|going|went|gone) on", "continues"),
    (r"(out of|in) balance", "unbalanced (residual) force; equilibrium"),
    (r"outer (force|work|power)s?", "external force, external work"),
    (r"following (pressure|load)s?", "follower load"),
    (r"dead pressures?", "dead load"),
    (r"parts of (the|an|its|each|every) (increment|step)s?|cut (in|into) parts", "substep, bisection"),
    (r"hang(s|ing)? together", "connected component"),
    (r"loose grains?", "floating grain (rattler)"),
    (r"held (grains?|nodes?|positions?|replicas?|ones|members?)|(grains?|nodes?|positions?|edges?|members?) (is|are|was|were) (all )?held", "fixed, prescribed"),
    (r"(grains?|footings?|body|bodies|middle one) turn(s|ed)?|(may|can|cannot|to) turn(?! (into|out|off|on|down))|turn of (the|a) (grains?|body|nodes?|arms?)|unit turn", "rotation, rotates"),
    (r"turned by", "rotated by"),
    (r"(look|looks|looked|looking) at (the |its |their |all )?(contacts?|pairs?)|farm('s)? looks?", "update contacts; inspect"),
    (r"footing's point", "point of load application"),
    (r"knobs?", "parameter"),
    (r"settings|(a|the|each|every|this|no|one|second|first|cheapest) setting", "configuration, parameter"),
    (r"(energy|work) defects?", "energy imbalance, work imbalance"),
    (r"anew", "again, recomputed"),
    (r"(study|studies) asks?|scenes? wants?", "a study measures, a scene requires"),
]
# What stays: regular expressions of a file and of its line.
ALLOWED = [
    # a value of micro.relaxation and --relaxation
    (r"", r"polished.*(damped|fire|default)|(damped|relaxation|\"|`).*polished|polished\)|^\| polished \|"),
]
SKIPPED = r"^(LICENSE|tests/data/|docs/figures/|scripts/words\.sh$|tests/system/words\.sh$)"


def blank(text):
    return re.sub(r"[^\n]", " ", text)


TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)


# Comments and string literals, everything else as blanks; marks of a comment and quotes are blanks, too.
def words_of_c(text):
    out, last = [], 0
    for m in TOKEN.finditer(text):
        out.append(blank(text[last:m.start()]))
        token = m.group()
        last = m.end()
        start = text.rfind("\n", 0, m.start()) + 1
        if token[0] == "'" or (token[0] == '"' and re.match(r"\s*#\s*include", text[start:m.start()])):
            out.append(blank(token))
        elif token[0] == '"':
            out.append(" " + token[1:-1].replace("\\n", "  ") + " ")
        else:
            out.append(re.sub(r"(?m)^\s*\*", lambda s: blank(s.group()), "  " + token[2:-2] + "  ") if token[1] == "*" else "  " + token[2:])
    return "".join(out) + blank(text[last:])


def words_of(path):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if re.search(r"\.(c|h|cpp|in\.c)$", path):
        return words_of_c(text)
    return re.sub(r"(?m)^\s*(#|\.\\\")+", lambda s: blank(s.group()), text)


def main(paths):
    if not paths:
        listed = subprocess.run(["git", "ls-files"], capture_output=True, text=True)
        if listed.returncode != 0:
            print(listed.stderr, end="", file=sys.stderr)
            return 2
        paths = [p for p in listed.stdout.splitlines() if not re.search(SKIPPED, p)]
        paths = [p for p in paths if re.search(r"(\.(c|h|cpp|sh|py|md|gp|mk|in|yaml|txt)|Makefile)$", p)]
    terms = [(re.compile(r"(?<![\w-])(?:" + t.replace(" ", r"\s+") + r")(?![\w-])", re.I), n) for t, n in TERMS]
    found = 0
    for path in paths:
        try:
            text = words_of(path)
        except OSError as error:
            print(f"words.sh: {path}: {error.strerror}", file=sys.stderr)
            return 2
        hits = [(m.start(), " ".join(m.group().split()), term) for expression, term in terms for m in expression.finditer(text)]
        for start, words, term in sorted(hits):
            begin = text.rfind("\n", 0, start) + 1
            end = text.find("\n", start)
            line = text[begin:end if end >= 0 else len(text)]
            if any(re.search(p, path) and re.search(w, line) for p, w in ALLOWED):
                continue
            print(f'{path}:{text.count(chr(10), 0, start) + 1}: "{words}": {term}')
            found = 1
    return found


sys.exit(main(sys.argv[1:]))
PYTHON
