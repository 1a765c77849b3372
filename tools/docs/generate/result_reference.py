#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the page of the numbers in results from what fracfit describes.

Usage: result_reference.py PROGRAM FILE
"""
import json
import pathlib
import subprocess
import sys

program, file = sys.argv[1], pathlib.Path(sys.argv[2])
rows = json.loads(subprocess.run([program, "describe", "--format", "json"], check=True, capture_output=True).stdout)["rows"]
page = ["# Numbers in results", "", "What `fracfit describe` prints: the keys of JSON and their units.  Units *residual*, *value* and *parameter* are",
        "those of the weighted residuals, of the data and of the parameter.", ""]
last = None
for row in rows:
    if row["result"] != last:
        last = row["result"]
        page += ["", f"## {last}", "", "| key | kind | unit | meaning |", "|---|---|---|---|"]
    meaning = row["meaning"].replace("|", "\\|")
    page.append(f"| `{row['key']}` | {row['kind']} | {row['unit']} | {meaning} |")
file.write_text("\n".join(page) + "\n")
