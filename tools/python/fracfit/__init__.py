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
    describing_function,
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
from ._model import Approximation, Margins, Model, Realisation, Stability, TimeResponse, approximate
from ._special import derivative, mittag_leffler

if TYPE_CHECKING:
    from ._economy import Economy, economy
    from ._fit import (
        BatchResult,
        CustomCircuit,
        FitResult,
        Identification,
        SceneIdentification,
        Tuning,
        Validation,
        batch,
        fit,
        identify,
        identify_scene,
        presets,
        tune,
        validate,
    )
    from .plots import plot_bode, plot_nyquist

__version__: str = _core.version

_LATER = {
    **dict.fromkeys(
        (
            "BatchResult",
            "CustomCircuit",
            "FitResult",
            "Identification",
            "SceneIdentification",
            "Tuning",
            "Validation",
            "batch",
            "fit",
            "identify",
            "identify_scene",
            "presets",
            "tune",
            "validate",
        ),
        "_fit",
    ),
    **dict.fromkeys(("Economy", "economy"), "_economy"),
    "plot_bode": "plots",
    "plot_nyquist": "plots",
}

__all__ = [
    "Approximation",
    "DescribingFunction",
    "FractionalPid",
    "FrequencyResponse",
    "LimitCycles",
    "Margins",
    "Model",
    "OrbitBranch",
    "Realisation",
    "RegimeMap",
    "Stability",
    "TimeResponse",
    "TimeSeries",
    "approximate",
    "derivative",
    "describing_function",
    "jump_frequency",
    "limit_cycles",
    "mittag_leffler",
    "orbits",
    "read",
    "regime_map",
    "restitution_from_loss_factor",
    "static_describing_function",
    "sweep_names",
    "symmetric_loss_factor",
    *_LATER,
]


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'fracfit' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(f".{_LATER[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(_LATER))
