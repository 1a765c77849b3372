# SPDX-License-Identifier: BSD-3-Clause
"""The installed component: complete, and free of libraries that it does not need."""

import os
import pathlib
import re
import subprocess
import sys

import command_line
import pytest

import fracfit

HERE = pathlib.Path(fracfit.__file__).parent


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    prefix = tmp_path_factory.mktemp("prefix")
    command = ["cmake", "--install", os.environ["FRACFIT_BUILD"], "--component", "python", "--prefix", str(prefix)]
    subprocess.run(command, check=True, capture_output=True)
    return next(prefix.rglob("fracfit/__init__.py")).parent


def test_every_file_is_installed(installed):
    names = lambda folder: {path.name for path in folder.iterdir() if path.is_file()}
    assert names(installed) == names(HERE)
    assert (installed / "py.typed").exists() and not (installed / "_fit.py").is_symlink()


def test_it_works_from_there(installed, tmp_path):
    code = (
        "import fracfit; data = fracfit.Model('2/(0.5 s^0.7 + 1)').frequency_response([0.1, 0.5, 1, 2, 5, 10]);"
        "print(fracfit.__file__, round(fracfit.fit(data, 'K/(T s^a + 1)')['a'], 9))"
    )
    environment = {**os.environ, "PYTHONPATH": str(installed.parent)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.split() == [str(installed / "__init__.py"), "0.7"], done.stderr


def test_the_core_links_the_runtime_of_cpp_alone(installed):
    core = next(installed.glob("_core.*.so"))
    text = subprocess.run(["ldd", core], check=True, capture_output=True, text=True).stdout
    names = {line.split()[0].split(".")[0].split("/")[-1] for line in text.splitlines()}
    assert names <= {"linux-vdso", "libstdc++", "libm", "libgcc_s", "libc", "ld-linux-x86-64"}


def test_stubs_name_what_the_extensions_have():
    import ast
    import importlib

    for name in ("_core", "_files", "_fitting"):
        module = importlib.import_module(f"fracfit.{name}")
        tree = ast.parse((HERE / f"{name}.pyi").read_text())
        told = {node.name for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        told |= {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign)}
        assert told == {each for each in vars(module) if not each.startswith("__")}
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                members = {each.name for each in node.body if isinstance(each, ast.FunctionDef)}
                assert members - {"__init__"} == {each for each in vars(getattr(module, node.name)) if not each.startswith("_")}


def test_the_wheel_is_described_as_the_project_is():
    pytest.importorskip("setuptools")
    pytest.importorskip("wheel")
    tomllib = pytest.importorskip("tomllib")
    root = pathlib.Path(command_line.DATA).parent
    told = tomllib.loads((root / "pyproject.toml").read_text())
    assert (root / told["project"]["readme"]).exists()
    code = "import wheel_backend as b; print(b.version, *b.OPTIONS)"
    environment = {**os.environ, "PYTHONPATH": str(root / told["build-system"]["backend-path"][0])}
    done = subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True, text=True)
    version, *options = done.stdout.split()
    # As PEP 440 spells a version between two releases.
    assert version == re.sub("-dev$", ".dev0", fracfit.__version__)
    lists = (root / "CMakeLists.txt").read_text()
    for option in options:
        assert f"option({option.split('=')[0]} " in lists


def test_without_the_solvers_the_rest_works_and_fits_say_why_not(installed, tmp_path):
    import shutil

    core = tmp_path / "fracfit"
    shutil.copytree(installed, core, ignore=shutil.ignore_patterns("_fitting.*"))
    code = "import fracfit; print(fracfit.Model('1/s')(1j))\ntry: fracfit.fit\nexcept ImportError as e: print(e)"
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, cwd=tmp_path, capture_output=True, text=True)
    first, second = done.stdout.splitlines()
    assert complex(first) == -1j and "cannot fit" in second and "Ceres" in second
