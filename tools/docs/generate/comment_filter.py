#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints a header for Doxygen: <x> in a comment is no HTML, and lines that are set in columns stay as they are.

Usage: comment_filter.py HEADER
"""
import re
import sys

# "///   name   meaning", or "/// name   meaning"; two blanks after a full stop only separate sentences.
aligned = re.compile(r"^ *///(?: {3,}\S.*[^\s.] {2,}\S| [^\s@]+(?: [^\s@]+)? {3,}\S)")
continued = re.compile(r"^ */// {3,}\S")

inside = False
for line in open(sys.argv[1], encoding="utf-8").read().splitlines():
    column = bool(aligned.match(line)) or (inside and bool(continued.match(line)))
    if column != inside:
        print("/// @verbatim" if column else "/// @endverbatim")
        inside = column
    if not column and line.lstrip().startswith("///"):
        line = re.sub(r"<([a-z_]*)>", r"&lt;\1&gt;", line)
    print(line)
