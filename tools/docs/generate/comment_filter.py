#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints a header for Doxygen: <x> in a comment is no HTML, lines that are set in columns stay as they are, and a comment
behind a member is its description.

Usage: comment_filter.py HEADER
"""
import re
import sys

# "///   name   meaning", or "/// name   meaning"; two blanks after a full stop only separate sentences.
aligned = re.compile(r"^ *///(?: {3,}\S.*[^\s.] {2,}\S| [^\s@]+(?: [^\s@]+)? {3,}\S)")
continued = re.compile(r"^ */// {3,}\S")
# "double omega;  // rad/s"
behind = re.compile(r"^( *[^/#} ].*[;,])( +)// (.+)$")

inside = False
for line in open(sys.argv[1], encoding="utf-8").read().splitlines():
    column = bool(aligned.match(line)) or (inside and bool(continued.match(line)))
    if column != inside:
        print("/// @verbatim" if column else "/// @endverbatim")
        inside = column
    code, sign, comment = line, "", ""
    if member := behind.match(line):
        code, sign, comment = member[1] + member[2], "///< ", re.sub("^>", r"\\>", member[3])
    elif line.lstrip().startswith("///") and not column:
        code, comment = "", line
    line = code + sign + re.sub(r"<([a-z_]*)>", r"&lt;\1&gt;", comment)
    print(line)
