#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the pictures of the gallery by the commands that stand on its page.

usage: gallery.py PROGRAM DATA PAGE      pictures named gallery/... go beside the page

The commands are run in a folder of their own, where `data` is that of the project; gallery/NAME on the page is NAME there."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def main(program, data, page):
    page = pathlib.Path(page)
    text = page.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(pathlib.Path(data).resolve(), f"{folder}/data")
        path = f"{pathlib.Path(program).resolve().parent}:{os.environ['PATH']}"
        for block in re.findall(r"^```console\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
            for command in re.findall(r"^\$ (.*)$", block, re.MULTILINE):
                done = subprocess.run(["bash", "-c", command], cwd=folder, env={**os.environ, "PATH": path}, text=True, capture_output=True)
                if done.returncode:
                    sys.exit(f"{page}: {command}: {done.stderr}")
        for name in re.findall(r"\]\(gallery/([^)]*)\)", text):
            target = page.parent / "gallery" / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(pathlib.Path(folder) / name, target)


if __name__ == "__main__":
    main(*sys.argv[1:])
