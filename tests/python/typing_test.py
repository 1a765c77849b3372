# SPDX-License-Identifier: BSD-3-Clause
"""Types: two hundred lines of ordinary use under a strict checker, and names that complete."""

import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

import fracfit

HERE = pathlib.Path(__file__).parent
MODULE = pathlib.Path(fracfit.__file__).parent


def test_ordinary_use_runs():
    subprocess.run([sys.executable, "-W", "error::DeprecationWarning", HERE / "ordinary_use.py"], check=True, capture_output=True)


def test_ordinary_use_is_typed(tmp_path):
    pytest.importorskip("mypy")
    settings = tmp_path / "mypy.ini"
    # As installed in site-packages, where a checker reads the types and judges the user's file alone.
    settings.write_text("[mypy]\n[mypy-fracfit.*]\nfollow_imports = silent\n")
    checked = [sys.executable, "-m", "mypy", "--strict", "--config-file", settings, "--cache-dir", tmp_path, HERE / "ordinary_use.py"]
    done = subprocess.run(checked, env={**os.environ, "MYPYPATH": str(MODULE.parent)}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert sum(1 for line in (HERE / "ordinary_use.py").read_text().splitlines() if line.strip()) >= 180


def test_ordinary_use_is_typed_for_pyright(tmp_path):
    pyright = shutil.which("pyright")
    if pyright is None:
        pytest.skip("pyright is not installed")
    (tmp_path / "ordinary_use.py").write_text((HERE / "ordinary_use.py").read_text())
    settings = {"typeCheckingMode": "strict", "extraPaths": [str(MODULE.parent)], "include": ["ordinary_use.py"]}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings))
    done = subprocess.run([pyright, "--pythonpath", sys.executable, "--project", tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_of_results_are_those_that_the_library_describes():
    root = pathlib.Path(os.environ["FRACFIT_DATA"]).parent
    assert subprocess.run([sys.executable, root / "tools/python/src/make_numbers", "--check"], check=False).returncode == 0


def test_names_complete():
    names = dir(fracfit)
    assert set(fracfit.__all__) <= set(names)
    assert not any(name.startswith("_") and not name.startswith("__") for name in names)
    data = fracfit.Model("1/(s + 1)").frequency_response([0.1, 1, 10])
    result = fracfit.fit(data, "K/(T s + 1)")
    for thing, expected in (
        (result, {"parameters", "rms", "cost", "covariance", "residuals", "plot", "to_dataframe"}),
        (fracfit.validate(data), {"validity", "noise", "summary", "plot"}),
        (fracfit.Model("1/(s + 1)").margins(), {"gain_margin", "phase_margin"}),
        (data, {"omega", "f", "response", "to_csv", "control"}),
    ):
        assert expected <= set(dir(thing))
