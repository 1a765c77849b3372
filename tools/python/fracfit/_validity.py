# SPDX-License-Identifier: BSD-3-Clause
"""Whether data can be a response, and what relaxation times are in it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ._arrays import Array, number, real_array, seed_number, text
from ._doors import response_of
from ._fit import FitResult, _described, _fitting
from ._model import Model, _Record
from ._numbers import RelaxationTimesNumbers, ValidationNumbers
from ._tables import Table, column_unit
from ._text import html_table, short
from ._words import named


@_described("Validation")
class Validation(_Record, ValidationNumbers, Table):
    """Whether data can be the response of a linear, causal, stable and steady system (Kramers, Kronig).

    Attributes
    ----------
    usable : bool
        Decided.
    summary : str
        The verdict in a sentence with its figures.
    """

    usable: bool
    summary: str
    model: Array
    deviation: Array
    data: Any

    @property
    def residuals(self) -> Array:
        """Data minus the consistent model over its modulus, NaN where a point was not judged or set aside."""
        return (self.data.response - self.model) / np.abs(self.model)

    def _columns(self) -> dict[str, Any]:
        residuals = self.residuals
        size = np.abs(self.model)
        return {"omega_rad_s": self.data.omega, "re_residual": residuals.real, "im_residual": residuals.imag, "noise": self.deviation / size}

    def _head(self) -> dict[str, str]:
        return {"validity": self.validity, "summary": self.summary}

    def plot(self, *, ax: Any = None, **style: Any) -> Any:
        """Residuals over frequency with the band that holds 95 % of the noise, with matplotlib."""
        from .plots import plot_residuals

        return plot_residuals(self, ax=ax, **style)

    def __repr__(self) -> str:
        return f"{self.validity}: {self.summary}"

    def _repr_html_(self) -> str:
        rows = [(each["test"], each["p_value"], "speaks against the data" if each["alarm"] else "") for each in self.findings]
        return html_table(["test", "chance by noise alone", ""], rows, repr(self))


@_described("RelaxationTimes")
class RelaxationTimes(_Record, RelaxationTimesNumbers, Table):
    """Distribution of relaxation times: Z = constant + inductance s + elastance/s + lines + integral of g/(1 + s tau) d ln tau.

    Attributes
    ----------
    follows_data : bool
        Whether it follows the data; False of a formula, which has none.
    unit : str
        Of the response, and with it of densities and areas.
    """

    follows_data: bool
    unit: str
    tau: Array
    density: Array
    lower: Array
    upper: Array

    def _columns(self) -> dict[str, Any]:
        unit = column_unit(self.unit)
        columns = {"tau_s": self.tau, f"density{unit}": self.density}
        return {**columns, f"lower{unit}": self.lower, f"upper{unit}": self.upper} if self.lower.size else columns

    def plot(self, *, ax: Any = None, **style: Any) -> Any:
        """Density over relaxation time with its range of 95 %, with matplotlib."""
        from .plots import plot_times

        return plot_times(self, ax=ax, **style)

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        lines = [f"RelaxationTimes({self.tau.size} times, {len(self.peaks)} peaks, {len(self.lines)} lines, kernel {self.kernel})"]
        for kind, entries in (("peak", self.peaks), ("line", self.lines)):
            lines.extend(f"  {kind} at {short(each['tau'])} s, area {short(each['area'])}{unit}" for each in entries)
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        unit = f", {self.unit}" if self.unit else ""
        rows = [
            (kind, each["tau"], each["area"], each["area_lower"], each["area_upper"])
            for kind, entries in (("peak", self.peaks), ("line", self.lines))
            for each in entries
        ]
        return html_table(["", "tau, s", "area" + unit, "from", "to (95 %)"], rows, repr(self).partition("\n")[0])


@named
def validate(
    data: Any, values: Any = None, *, component: str | None = None, level: float = 0.05, accuracy: float = 1e-4, tolerance: float = 0.01
) -> Validation:
    """Whether measured data can be the response of a linear, causal, stable system that stayed the same (Kramers, Kronig).

    Parameters
    ----------
    data : FrequencyResponse, or the like
        As of `fit`; ``validate(f, Z)`` takes two arrays.
    component : {"impedance", "admittance"}, optional
        Which of both is judged, made of the other where the unit of the data is that of the other: an admittance where the
        voltage was held, which needs no stable impedance.
    level : float
        Chance that data without a fault are not called valid, between 0 and 1.
    accuracy : float
        Systematic error that the instrument may have, as share of the response; departures within it are no fault.
    tolerance : float
        Departures of the points as a whole that are significant but no larger, as share of the response, do not make data
        invalid.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> exact = fracfit.Model("2/(0.5 s^0.7 + 1)").frequency_response(np.logspace(-1, 2, 40))
    >>> fracfit.validate(exact).validity, fracfit.validate(exact.f, exact.response[::-1]).validity
    ('valid', 'invalid')
    """
    points = response_of(data, values)
    if component is not None:
        if text(component, "component") not in ("impedance", "admittance"):
            raise ValueError(f"component is {component!r}; expected impedance or admittance")
        points = points._as_immittance(component)
    level, accuracy, tolerance = number(level, "level"), number(accuracy, "accuracy"), number(tolerance, "tolerance")
    if not 1e-15 <= level < 1:
        raise ValueError(f"level is {level:g}; allowed is 1e-15 up to 1")
    if not 0 <= accuracy < 1:
        raise ValueError(f"accuracy is {accuracy:g}; allowed is 0 up to 1")
    if not 0 <= tolerance < 1:
        raise ValueError(f"tolerance is {tolerance:g}; allowed is 0 up to 1")
    found = _fitting.validate(points._arrays(), level, accuracy, tolerance)
    found["model"] = _or_nan(np.array(found["model"], dtype=complex), points.size)
    found["deviation"] = _or_nan(np.array(found["deviation"], dtype=float), points.size)
    return Validation({**found, "data": points})


def _or_nan(given: Array, size: int) -> Array:
    return given if given.size == size else np.full(size, math.nan, dtype=given.dtype)


@named
def drt(
    data: Any,
    values: Any = None,
    *,
    tau: Any = None,
    kernel: str | None = None,
    seed: int = 1,
) -> RelaxationTimes:
    """Distribution of relaxation times, of a fit or model exactly or of measured data without a model.

    Parameters
    ----------
    data : FrequencyResponse, FitResult, Model, or the like
        Data give the smoothest density that follows them to within their noise; a fit or a model that of its formula.
    tau : array_like, optional
        Times at which a fit or a model is shown, s, rising; six decades beyond those of the data of a fit by default.
    kernel : {"falling", "rising"}, optional
        What a time contributes, g/(1 + s tau) (impedance, compliance, permittivity) or g s tau/(1 + s tau) (modulus,
        admittance); by default falling, or rising where only that follows the data or makes the density positive.
    seed : int
        Of the intervals of data.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> arc = fracfit.Model("1/(1 + (0.01 s)^0.8)")
    >>> found = fracfit.drt(arc, tau=np.logspace(-4, 0, 81))
    >>> round(float(found.tau[found.density.argmax()]), 9)
    0.01
    """
    if kernel is not None and text(kernel, "kernel") not in ("falling", "rising"):
        raise ValueError(f"kernel is {kernel!r}; expected falling or rising")
    times = None if tau is None else real_array(tau, "tau")
    if isinstance(data, (FitResult, Model)):
        return _of_formula(data, times, kernel)
    points = response_of(data, values)
    if times is not None:
        raise ValueError("tau has no meaning with data, whose band tells the times; it is for fits and models")
    found = _fitting.times_of_data(points._arrays(), kernel or "falling", seed_number(seed))
    if kernel is None and not found["follows_data"]:
        rising = _fitting.times_of_data(points._arrays(), "rising", seed_number(seed))
        found = rising if rising["follows_data"] else found
    return _times(found, points.unit)


def _of_formula(given: FitResult | Model, times: Array | None, kernel: str | None) -> RelaxationTimes:
    if times is None:
        omega = getattr(given.data, "omega", None) if isinstance(given, FitResult) else None
        if omega is None:
            raise ValueError("a model needs tau, the times at which its distribution is shown, s")
        times = np.geomspace(1e-6 / omega[-1], 1e6 / omega[0], 400)

    def distribution(of: str) -> dict[str, Any]:
        if isinstance(given, FitResult):
            return _fitting.times_of_fit(given._values, times, of)
        return _fitting.times_of_model(given._structure, given._values(), times, of)

    found = distribution(kernel or "falling")
    if kernel is None and _area(found) < 0:
        found = distribution("rising")
    return _times(found, getattr(getattr(given, "data", None), "unit", ""))


def _area(found: dict[str, Any]) -> float:
    density, times = np.array(found["density"]), np.log(found["tau"])
    return float(np.sum(0.5 * (density[1:] + density[:-1]) * np.diff(times)) + sum(each["area"] for each in found["lines"]))


def _times(found: dict[str, Any], unit: str) -> RelaxationTimes:
    arrays = {name: np.array(found[name], dtype=float) for name in ("tau", "density", "lower", "upper")}
    return RelaxationTimes({**found, **arrays, "unit": unit})
