#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds what the extensions of a wheel link against the rules of manylinux (PEP 600), for which Debian 12 has no auditwheel.

usage: wheel_links.py WHEEL

A wheel that is passed on may use the libraries that PEP 513 lists, in versions of its symbols that the C library named in its tag
has; all others have to be packed into it.  What they are is told, and that the list on the page is true."""

import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

# PEP 513, what of it a program without windows can meet, and the loader of Linux.
ALLOWED = re.compile(r"(libgcc_s|libstdc\+\+|libm|libdl|librt|libc|libpthread|libutil|libresolv|libz|ld-linux-[\w-]+)\.so\.\d+")
# Of each extension, the other libraries that it needs: what Ceres, glog, NLopt, Boost.Iostreams and libzip bring.
OTHERS = {
    "_core": set(),
    "_files": {"zip"},
    "_fitting": {"ceres", "glog", "nlopt", "cholmod", "spqr", "cxsparse", "lapack", "blas", "f77blas", "openblas"},
}
OTHERS["_report"] = OTHERS["_fitting"] | OTHERS["_files"] | {"boost_iostreams"}


def lines(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main(wheel):
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(folder)
        extensions = sorted(pathlib.Path(folder).rglob("*.so"))
        told = set(OTHERS) - {"_report"}
        found = {path.name.split(".")[0] for path in extensions}
        if not told <= found:
            wrong.append(f"the wheel lacks {sorted(told - found)}")
        for path in extensions:
            name = path.name.split(".")[0]
            dynamic = lines("readelf", "-dW", path)
            needed = re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic)
            others = {re.sub(r"^lib|\.so.*", "", each) for each in needed if not ALLOWED.fullmatch(each)}
            versions = re.findall(r"\b(GLIBC|GLIBCXX|CXXABI)_(\d[\d.]*)", lines("readelf", "-VW", path))
            highest = {}
            for library, number in versions:
                highest[library] = max(highest.get(library, (0,)), tuple(map(int, number.rstrip(".").split("."))))
            spelled = ", ".join(f"{library}_{'.'.join(map(str, number))}" for library, number in sorted(highest.items()))
            print(f"{name}: {spelled}; to be packed along: {', '.join(sorted(others)) or 'nothing'}")
            if not others <= OTHERS.get(name, set()):
                wrong.append(f"{name} links {sorted(others - OTHERS.get(name, set()))} besides")
            if re.search(r"\((RPATH|RUNPATH)\)", dynamic):
                wrong.append(f"{name} has a path of this machine in it")
            # One name alone, that which Python looks up.
            shown = re.findall(r"^[0-9a-f]+ [TDBRi] (\S+)$", lines("nm", "-D", "--defined-only", path), re.MULTILINE)
            if shown != [f"PyInit_{name}"]:
                wrong.append(f"{name} shows the names {shown[:5]}")
    for sentence in wrong:
        print(sentence, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
