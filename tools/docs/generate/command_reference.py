#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes one page per command of fracfit from what it prints for --help.

Usage: command_reference.py PROGRAM FOLDER
"""
import pathlib
import re
import subprocess
import sys

program, folder = sys.argv[1], pathlib.Path(sys.argv[2])


def help_of(*words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def blocks(text):
    """The lines before the first heading, then (heading, lines) for each 'Heading:' at the left edge."""
    result = [("", [])]
    for line in text.splitlines():
        if re.fullmatch(r"[A-Z][A-Za-z ]*:", line):
            result.append((line[:-1], []))
        else:
            result[-1][1].append(line)
    return result


def entries(lines):
    """(name, meaning) of a list whose meanings are indented further than the names."""
    found = []
    for line in lines:
        name = re.match(r"  (\S.*?)(?:\s{2,}(\S.*))?$", line)
        if name and not line.startswith("   "):
            found.append([name.group(1), name.group(2) or ""])
        elif line.strip() and found:
            found[-1][1] = (found[-1][1] + " " + line.strip()).strip()
    return found


def escaped(text):
    return re.sub(r"([\\*_<>\[\]|$`#])", r"\\\1", text)


def command_page(name, summary):
    page = [f"# fracfit {name}", "", escaped(summary) + ".", ""]
    for heading, lines in blocks(help_of(*name.split(), "--help")):
        if not heading:
            page += [f"`{line[7:]}`" for line in lines if line.startswith("Usage: ")] + [""]
        elif heading == "Examples":
            page += ["## Examples", "", "```sh", *[line.strip() for line in lines if line.strip()], "```", ""]
        else:
            page += [f"## {heading}", ""]
            for option, meaning in entries(lines):
                required = option.endswith(" REQUIRED")
                page += [f"`{option.removesuffix(' REQUIRED')}`" + (" (required)" if required else ""),
                         f": {escaped(meaning)}", ""]
    return "\n".join(page)


folder.mkdir(parents=True, exist_ok=True)
index = ["# Commands", "", "What `fracfit COMMAND --help` prints, one page per command. `fracfit man` writes the same as a manual",
         "page and `source <(fracfit completion)` completes it in a shell.", ""]
overview = blocks(help_of("--help"))
pages = 0
for heading, lines in overview:
    if heading in ("", "Options", "Examples"):
        continue
    index += [f"## {heading}", ""]
    names = []
    for name, summary in entries(lines):
        file = name.replace(" ", "-")
        (folder / f"{file}.md").write_text(command_page(name, summary))
        index += [f"[`{name}`]({file}.md)", f": {escaped(summary)}", ""]
        names.append(file)
    index += ["```{toctree}", ":hidden:", *names, "```", ""]
    pages += len(names)
codes = re.search(r"Exit codes: (.*)", help_of("--help"))
if pages == 0 or codes is None:
    sys.exit("the help of " + program + " is not of the form that this script reads")
index += ["Exit codes: " + codes.group(1), ""]
(folder / "index.md").write_text("\n".join(index))
