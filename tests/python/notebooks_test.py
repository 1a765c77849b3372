# SPDX-License-Identifier: BSD-3-Clause
"""The notebooks: their cells run as they stand, without Jupyter, find what their data were made with, and are kept without outputs."""

import json
import math
import os
import pathlib

import numpy as np
import pytest

import fracfit

ROOT = pathlib.Path(os.environ["FRACFIT_DATA"]).parent
FOLDER = ROOT / "tools/docs/notebooks"


def impedance(names):
    # The example was computed with n1 = 0.85; both intervals hold it, and the verdict is for two arcs, n below 1.
    for lower, upper in (names["by_curvature"], names["by_profile"][:2]):
        assert lower < 0.85 < upper
    assert names["validity"].validity == "valid"
    assert len(names["times"].peaks) == 2
    assert names["ranking"].best.formula == fracfit.presets()["two-zarc"]


def fractional_pid(names):
    # The demands, by the closed loop's own numbers: |L| = 1 at 0.008 rad/s with a phase of 60 - 180 degrees, and level there.
    loop = names["open_loop"]
    at = loop.frequency_response(0.008 * np.array([0.999, 1.0, 1.001])).response
    assert abs(at[1]) == pytest.approx(1, rel=1e-6)
    assert math.degrees(np.angle(at[1])) == pytest.approx(-120, abs=1e-4)
    # Level: the slope is 0 at the crossover, so over 0.1 % to either side the phase bends by less than its curvature, some 1e-6.
    assert abs(np.angle(at[2] / at[0])) < 1e-5
    overshoot = names["overshoot"]
    assert max(overshoot.values()) - min(overshoot.values()) < 0.05 < max(overshoot.values())
    assert names["pid"].error < 0.1


def backlash(names):
    assert names["symmetric"].sum() > 5
    # Exact where the motion is symmetric; the orbits are closed to 1e-10 of the gap.
    np.testing.assert_allclose([names["loss"].min(), names["loss"].max()], names["expected"], rtol=1e-8)
    assert names["impacts"] == 4
    # Noise of 1 %: five standard errors.
    for each, truth in zip(names["found"].parameters, (1, 1, 0.3, 0.6)):
        assert abs(each["value"] - truth) <= 5 * each["standard_error"]


def rig(names):
    assert names["found"].excitation == "periodic" and names["found"].period == pytest.approx(40, rel=1e-9)
    result = names["result"]
    for name, truth in (("K", 2), ("T", 0.5), ("a", 0.7)):
        assert abs(result[name] - truth) < 5 * result.standard_errors[name]
    assert result.weight == "given"
    assert names["ranking"].best.formula == fracfit.presets()["fractional-lag"]


CHECKS = {"impedance": impedance, "fractional-pid": fractional_pid, "backlash": backlash, "rig": rig}


def test_every_notebook_is_checked():
    assert {each.stem for each in FOLDER.glob("*.ipynb")} == set(CHECKS)


@pytest.mark.parametrize("name", CHECKS)
def test_a_notebook_runs(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    book = json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    cells = book["cells"]
    assert cells[0]["cell_type"] == "markdown" and "".join(cells[0]["source"]).startswith("# ")
    assert len({cell["id"] for cell in cells}) == len(cells)
    names = {}
    for i, cell in enumerate(cells):
        if cell["cell_type"] != "code":
            continue
        assert cell["outputs"] == [] and cell["execution_count"] is None, f"cell {i + 1} keeps outputs"
        exec(compile("".join(cell["source"]), f"{name}.ipynb, cell {i + 1}", "exec"), names)
    CHECKS[name](names)
