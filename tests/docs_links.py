#!/usr/bin/env python3
"""Links of documents: docs_links.py PAGE...: each file and heading that a page links to is there. Prints what is missing.
SPDX-License-Identifier: GPL-2.0-or-later"""

import os
import re
import sys
import unicodedata


def without_code(text):
    return re.sub(r"```.*?```", "", text, flags=re.S)


def anchors(path):
    """Names of headings as forges make them."""
    with open(path, encoding="utf-8") as page:
        text = without_code(page.read())
    found = set()
    for title in re.findall(r"^#+ +(.*)$", text, flags=re.M):
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).strip().lower()
        name = "".join(c for c in title if c in " -_" or unicodedata.category(c)[0] in "LN").replace(" ", "-")
        while name in found:
            name += "-1"
        found.add(name)
    return found


def missing(page):
    with open(page, encoding="utf-8") as file:
        text = re.sub(r"`[^`\n]*`", "", without_code(file.read()))
    for target in re.findall(r"\]\(([^)\s]+)\)|src=\"([^\"]+)\"", text):
        target = target[0] or target[1]
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        whole = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        if not os.path.exists(whole):
            yield f"{page}: {target}: there is no {whole}"
        elif anchor and anchor not in anchors(whole):
            yield f"{page}: {target}: there is no such heading"


def main(pages):
    lines = [line for page in pages for line in missing(page)]
    print("\n".join(lines))
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
