# SPDX-License-Identifier: BSD-3-Clause
"""The examples of all docstrings, and that every public name has one."""

import doctest
import importlib
import inspect
import os
import pathlib

import numpy as np
import pytest

import fracfit

# NumPy 2 writes the type of each scalar beside its value; the examples show values.
if int(np.__version__.split(".")[0]) >= 2:
    np.set_printoptions(legacy="1.25")

MODULES = sorted(path.stem for path in pathlib.Path(fracfit.__file__).parent.glob("*.py"))


@pytest.mark.parametrize("name", MODULES)
def test_examples_give_what_they_say(name):
    module = fracfit if name == "__init__" else importlib.import_module(f"fracfit.{name}")
    failed, _ = doctest.testmod(module)
    assert failed == 0


@pytest.mark.parametrize("page, least", [("tools/docs/python.md", 20), ("tools/docs/coming-from.md", 10), ("README.md", 8)])
def test_examples_of_pages_give_what_they_say(page, least, monkeypatch):
    root = pathlib.Path(os.environ["FRACFIT_DATA"]).parent
    monkeypatch.chdir(root)
    failed, attempted = doctest.testfile(str(root / page), module_relative=False)
    assert failed == 0 and attempted >= least


@pytest.mark.parametrize("name", fracfit.__all__)
def test_public_names_are_documented(name):
    thing = getattr(fracfit, name)
    assert inspect.getdoc(thing)
    for member, value in vars(thing).items() if inspect.isclass(thing) else ():
        if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
            assert inspect.getdoc(getattr(thing, member)), f"{name}.{member}"
