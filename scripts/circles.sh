#!/usr/bin/env bash
# Circles of calls: scripts/circles.sh [BUILD]. Lists, from the symbols of the object files below BUILD/src, groups of files of one
# module that call each other in a circle, groups of modules that do, and headers of another module that a source file includes.
# One finding a line on standard output; exit status 1 when there is one. SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/.." || exit 2
build=${1:-${BUILD:-build}}

# Headers that are private to the library but serve all of its modules, and what the program calls studies by.
shared='^(base/[a-z0-9_]+|contact/[a-z0-9_]+|io/file|io/json|packing/random|study/study)\.h$'

# Source, kind and name of each symbol with external linkage: "src/macro/newton.c T gh_newton". Objects of sources that have gone may
# still lie in the build.
symbols() {
  find "$build/src" -name '*.o' | sort | while read -r object; do
    source=${object#"$build"/}
    [ -f "${source%.o}" ] && echo "$object"
  done | xargs nm -A -g | sed -nE "s|^$build/(.*)\.o: *[0-9a-f]* ([A-Zu]) (.*)|\1 \2 \3|p"
}

circles() {
  symbols | /usr/bin/python3 -c '
import sys
import os
from collections import defaultdict

home, needs = {}, []
for line in sys.stdin:
    source, kind, name = line.rstrip("\n").split(" ", 2)
    if kind == "U":
        needs.append((source, name))
    elif kind in "TDBRCu":  # not W and V: inline functions of C++ are in many objects
        home[name] = source
module = lambda source: os.path.dirname(source)[len("src/"):]
calls, between, why = defaultdict(set), defaultdict(set), {}
for source, name in needs:
    to = home.get(name)
    if to is None or to == source:
        continue
    if module(to) == module(source):
        if not source.endswith(".cpp"):  # LAMMPS decides how its styles know each other
            calls[source].add(to)
            why.setdefault((source, to), name)
    else:
        between[module(source)].add(module(to))
        why.setdefault((module(source), module(to)), "%s: %s" % (source, name))

def components(graph):  # Tarjan
    order, low, stack, found = {}, {}, [], []
    def visit(v):
        order[v] = low[v] = len(order)
        stack.append(v)
        for w in sorted(graph.get(v, ())):
            if w not in order:
                visit(w)
                low[v] = min(low[v], low[w])
            elif w in stack:
                low[v] = min(low[v], order[w])
        if low[v] == order[v]:
            group = []
            while not group or group[-1] != v:
                group.append(stack.pop())
            if len(group) > 1:
                found.append(sorted(group))
    for v in sorted(graph):
        if v not in order:
            visit(v)
    return found

sys.setrecursionlimit(10000)
for what, graph in (("files", calls), ("modules", between)):
    for group in components(graph):
        links = ["%s -> %s (%s)" % (a, b, why[a, b]) for a in group for b in sorted(graph[a]) if b in group]
        print("circle of %s: %s: %s" % (what, ", ".join(group), "; ".join(links)))
'
}

# Engines are rooms of one module.
includes() {
  find src driver -name '*.[ch]' -o -name '*.cpp' 2>/dev/null | sort | xargs grep -nE '^#include "' /dev/null |
    sed -E 's|^([^:]*):([0-9]*):#include "([^"]*)".*|\1 \2 \3|' | while read -r source line header; do
      case $header in granhom/* | */*) ;; *) continue ;; esac
      own=${source#src/} own=${own%%/*}
      [ "${header%%/*}" = granhom ] || [ "${header%%/*}" = "$own" ] || [[ $header =~ $shared ]] ||
        echo "header of another module: $source:$line includes $header"
    done
}

found=$(circles; includes)
[ -z "$found" ] && exit 0
echo "$found"
exit 1
