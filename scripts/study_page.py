"""Tables and pictures of the studies: study_page.py OUTDIR PAGE.md

Replaces what stands between `<!-- begin study NAME -->` and `<!-- end study NAME -->` in PAGE.md by the table of OUTDIR/NAME/study.md, and copies the
pictures that the page shows as ../figures/study-NAME-PICTURE.png from OUTDIR/NAME/PICTURE.png. Python's own library only.
SPDX-License-Identifier: GPL-2.0-or-later"""
import os
import re
import shutil
import sys

out, page = sys.argv[1:]
with open(page) as f:
    text = f.read()


def folded(lines):
    """Tables of more than a dozen rows open on demand."""
    text, block = [], []
    for line in lines + [""]:
        if line.startswith("|"):
            block.append(line)
            continue
        if len(block) > 14:
            block = ["<details><summary>Table: %d settings</summary>" % (len(block) - 2), "", *block, "", "</details>"]
        text += block + [line]
        block = []
    return "\n".join(text)


def table(match):
    path = os.path.join(out, match[2], "study.md")
    if not os.path.exists(path):
        print(f"{page}: no results of study {match[2]}: its table stays as it is", file=sys.stderr)
        return match[0]
    with open(path) as f:
        lines = f.read().strip().splitlines()
    if lines and lines[0].startswith("# "):  # the page has headings of its own
        lines = lines[1:]
    return match[1] + "\n\n" + folded(lines).strip() + "\n\n" + match[3]


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
