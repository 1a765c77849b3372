# SPDX-License-Identifier: BSD-3-Clause
"""Fractional-order models, their fits to data, and describing functions of two masses with backlash.

Frequencies are angular, in rad/s, unless a name says ``f``, which is Hz.  What is wrong with an argument is a ValueError,
what is wrong with a file or a computation a RuntimeError; a computation that ended without a usable result says so in
its result.  Ctrl-C stops long computations.  Those of the names below that fit (`fit`, `identify`, `tune` and the like)
load a second module, with Ceres and NLopt, when they are first used.

Examples
--------
>>> import fracfit
>>> plant = fracfit.Model("K/(T s^a + 1)", K=2, T=0.5, a=0.7)
>>> omega, response = plant.frequency_response([0.1, 1, 10])
>>> result = fracfit.fit(fracfit.FrequencyResponse(omega, response), "K/(T s^a + 1)")
>>> round(result["a"], 9)
0.7
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _core
from ._backlash import (
    DescribingFunction,
    LimitCycles,
    OrbitBranch,
    RegimeMap,
    contact_of_frequency,
    describing_function,
    drive,
    free_contact,
    jump_frequency,
    limit_cycles,
    orbits,
    regime_map,
    restitution_from_loss_factor,
    static_describing_function,
    symmetric_loss_factor,
)
from ._controller import FractionalPid
from ._data import FrequencyResponse, TimeSeries, read, sweep_names
from ._motions import Basins, History, LoopMotion, RigRecord, basins, history, loop
from ._model import Approximation, DigitalPower, Margins, Model, Realisation, Stability, TimeResponse, approximate
from ._records import Multisine, RecordResponse, SteppedSinePlan, multisine, response, stepped_sine_plan
from ._special import derivative, mittag_leffler

if TYPE_CHECKING:
    from ._economy import Economy as Economy, economy as economy
    from ._exports import (
        Circuit as Circuit,
        export_arduino as export_arduino,
        export_c99 as export_c99,
        export_fmu as export_fmu,
        export_spice as export_spice,
        report as report,
    )
    from ._fit import (
        BatchResult as BatchResult,
        CustomCircuit as CustomCircuit,
        FitBand as FitBand,
        FitPoints as FitPoints,
        FitResult as FitResult,
        Identification as Identification,
        SceneIdentification as SceneIdentification,
        Tuning as Tuning,
        batch as batch,
        fit as fit,
        identify as identify,
        identify_scene as identify_scene,
        presets as presets,
        tune as tune,
    )
    from ._joint import (
        JointFit as JointFit,
        JumpConstants as JumpConstants,
        JumpLaw as JumpLaw,
        MasterCurve as MasterCurve,
        joint_fit as joint_fit,
        jump_law as jump_law,
    )
    from ._validity import RelaxationTimes as RelaxationTimes, Validation as Validation, drt as drt, validate as validate
    from .plots import plot_bode as plot_bode, plot_nyquist as plot_nyquist

__version__: str = _core.version

_LATER = {
    **dict.fromkeys(
        (
            "BatchResult",
            "CustomCircuit",
            "FitBand",
            "FitPoints",
            "FitResult",
            "Identification",
            "SceneIdentification",
            "Tuning",
            "batch",
            "fit",
            "identify",
            "identify_scene",
            "presets",
            "tune",
        ),
        "_fit",
    ),
    **dict.fromkeys(("Economy", "economy"), "_economy"),
    **dict.fromkeys(("Circuit", "export_arduino", "export_c99", "export_fmu", "export_spice", "report"), "_exports"),
    **dict.fromkeys(("JointFit", "JumpConstants", "JumpLaw", "MasterCurve", "joint_fit", "jump_law"), "_joint"),
    **dict.fromkeys(("RelaxationTimes", "Validation", "drt", "validate"), "_validity"),
    "plot_bode": "plots",
    "plot_nyquist": "plots",
}

__all__ = [
    "Approximation",
    "Basins",
    "DescribingFunction",
    "DigitalPower",
    "FractionalPid",
    "FrequencyResponse",
    "History",
    "LimitCycles",
    "LoopMotion",
    "Margins",
    "Model",
    "Multisine",
    "OrbitBranch",
    "Realisation",
    "RecordResponse",
    "RegimeMap",
    "RigRecord",
    "Stability",
    "SteppedSinePlan",
    "TimeResponse",
    "TimeSeries",
    "approximate",
    "basins",
    "contact_of_frequency",
    "derivative",
    "describing_function",
    "drive",
    "free_contact",
    "history",
    "jump_frequency",
    "limit_cycles",
    "loop",
    "mittag_leffler",
    "multisine",
    "orbits",
    "read",
    "regime_map",
    "response",
    "restitution_from_loss_factor",
    "static_describing_function",
    "stepped_sine_plan",
    "sweep_names",
    "symmetric_loss_factor",
    *_LATER,
]


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        from ._words import meant

        suggestion = "" if name.startswith("_") else meant(name, __all__)
        raise AttributeError(f"module 'fracfit' has no attribute {name!r}{suggestion}")
    from importlib import import_module

    value = getattr(import_module(f".{_LATER[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({"__version__", *__all__, *(name for name in globals() if name.startswith("__"))})
