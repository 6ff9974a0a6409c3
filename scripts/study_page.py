"""Tables and pictures of the studies: study_page.py OUTDIR PAGE.md

Replaces what stands between `<!-- begin study NAME -->` and `<!-- end study NAME -->` in PAGE.md by a compact form of the table in
OUTDIR/NAME/study.md (one cell per configuration: error and seconds), and copies the pictures that the page shows as
../figures/study-NAME-PICTURE.png from OUTDIR/NAME/PICTURE.png. Python's own library only.
SPDX-License-Identifier: GPL-2.0-or-later"""
import os
import re
import shutil
import sys


def cells(line):
    return [c.strip() for c in line.strip().strip("|").split("|")]


def tables(lines):
    """Tables of a Markdown text as (head, rows)."""
    found, block = [], []
    for line in lines + [""]:
        if line.startswith("|"):
            block.append(cells(line))
        elif block:
            found.append((block[0], block[2:]))
            block = []
    return found


def short(value):
    """A value of a parameter without what all of its values share."""
    value = re.sub(r"packings/|-?(00)?\\\*|\.data", "", value)
    if found := re.fullmatch(r"\{gmsh: (?:.*/)?([^/}]+)\.msh\}", value):
        return found[1]
    if found := re.fullmatch(r"\[(\d+), (\d+)\]", value):
        return f"{found[1]} x {found[2]}"
    return value


def cell(row):
    """Error (seconds); of an ensemble the error of the mean +- its 95 % interval, then that of a single packing."""
    name = next(k for k in row if k.startswith("error of"))
    error = re.sub(r" \[\d+\]", "", row[name])
    if error == "failed":
        return error
    if error not in ("reference", "0") and "+- 95 %" in row:
        error += f" +- {row['+- 95 %']}, {row['single packing']}"
    of = row.get("packings", "1 of 1").split(" of ")
    return f"{error} ({row['seconds']})" + (f", {of[0]} of {of[1]}" if of[0] != of[1] else "")


def pivot(head, rows):
    """The parameter with the most values in rows (every second of more than eight), the others in columns, named in the first cell."""
    first = next(k for k, name in enumerate(head) if name.startswith("error of"))
    keys, measured = head[:first], [dict(zip(head, r)) for r in rows]
    values = {k: list(dict.fromkeys(r[k] for r in measured)) for k in keys}
    down = max(keys, key=lambda k: len(values[k]))
    others = [k for k in keys if k != down]
    across = list(dict.fromkeys(tuple(r[k] for k in others) for r in measured))
    at = {(r[down], tuple(r[k] for k in others)): cell(r) for r in measured}
    rest = values[down] if len(values[down]) <= 8 else values[down][::-2][::-1]
    lines = [["; ".join(f"`{k}`" for k in [down] + others)] + [", ".join(map(short, a)) or "error (seconds)" for a in across]]
    lines += [["---"] * (1 + len(across))] + [[short(v)] + [at.get((v, a), "") for a in across] for v in rest]
    return [f"| {' | '.join(line)} |" for line in lines]


def orders(head, rows):
    """The table of fitted orders as a sentence."""
    texts = [f"{short(r[0])} {r[1]} (from {r[2]} to {r[3]})" if r[1] != "-" else f"{short(r[0])} none" for r in rows]
    return f"{head[1].capitalize()}: {'; '.join(texts)}."


def compact(lines):
    found = tables(lines)
    text = "\n".join(lines)
    error = next(name for name in found[0][0] if name.startswith("error of"))
    ensemble = "+- 95 %" in found[0][0]
    reference = re.search(r"compared with the same with (.*?)\.( This is the short version.*)?$", text, re.M)
    took = re.search(r"The references? took ([\d.e+-]+(?: to [\d.e+-]+)? s) of one core", text)
    caption = error.capitalize() + (", ensemble" if ensemble else "")
    if reference:
        values = ", ".join(f"{k} {short(v)}" for k, v in (p.split(" ", 1) for p in re.split(r", (?=[a-z_.]+ )", reference[1])))
        caption += f"; reference: {values}" + (f" ({took[1]})" if took else "") + ("; short version" if reference[2] else "")
    parts = [caption + ".", "\n".join(pivot(*found[0]))]
    return "\n\n".join(parts + [orders(*t) for t in found[1:] if len(t[0]) > 1 and t[0][1].startswith("order in")])


def main():
    out, page = sys.argv[1:]
    with open(page) as f:
        text = f.read()

    def table(match):
        path = os.path.join(out, match[2], "study.md")
        if not os.path.exists(path):
            print(f"{page}: no results of study {match[2]}: its table stays as it is", file=sys.stderr)
            return match[0]
        with open(path) as f:
            return match[1] + "\n\n" + compact(f.read().strip().splitlines()) + "\n\n" + match[3]

    text = re.sub(r"(<!-- begin study ([\w-]+) -->).*?(<!-- end study \2 -->)", table, text, flags=re.S)
    for name, picture in re.findall(r"figures/study-([\w-]+?)-(work-precision-count|work-precision|order|curves)\.png", text):
        source = os.path.join(out, name, f"{picture}.png")
        if os.path.exists(source):
            shutil.copy(source, os.path.join(os.path.dirname(page), "..", "figures", f"study-{name}-{picture}.png"))
        else:
            print(f"{page}: study {name} has no picture {picture}.png", file=sys.stderr)
    with open(page + ".tmp", "w") as f:
        f.write(text)
    os.replace(page + ".tmp", page)


main()
