# SPDX-License-Identifier: BSD-3-Clause
"""Pictures with matplotlib, which is needed for nothing else."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._data import FrequencyResponse, TimeSeries
from ._model import Model


def plot_bode(*curves: Any, omega: Any = None, axes: Any = None, labels: Any = None, **style: Any) -> Any:
    """Magnitude and phase over frequency: in Hz where all data name theirs so, else in rad/s.

    Parameters
    ----------
    *curves : FrequencyResponse or Model
        Models are drawn at `omega`, or over the frequencies of the data.
    omega : array_like, optional
        rad/s.
    axes : pair of matplotlib axes, optional
        Where to draw; a new picture if not given.
    labels : sequence of str, optional
        For the legend.
    **style
        Passed on to matplotlib.

    Returns
    -------
    array of two matplotlib axes

    Examples
    --------
    >>> import fracfit
    >>> upper, lower = fracfit.plot_bode(fracfit.Model("1/(s^0.5 + 1)"), omega=[0.1, 1, 10])
    >>> lower.get_xlabel()
    'angular frequency, rad/s'
    """
    data = _responses(curves, omega)
    if axes is None:
        import matplotlib.pyplot as plt

        _, axes = plt.subplots(2, 1, sharex=True, constrained_layout=True)
    upper, lower = axes
    measured = [curve for curve, is_model in data if not is_model]
    in_hertz = bool(measured) and all(curve.frequency_unit == "Hz" for curve in measured)
    for (curve, is_model), label in zip(data, labels or [None] * len(data)):
        kind = {"linestyle": "-"} if is_model else {"linestyle": "none", "marker": ".", "markersize": 4}
        axis = curve.f if in_hertz else curve.omega
        upper.loglog(axis, curve.magnitude, label=label, **{**kind, **style})
        lower.semilogx(axis, np.degrees(curve.phase), label=label, **{**kind, **style})
    unit = next((curve.unit for curve, _ in data if curve.unit), "")
    upper.set_ylabel("magnitude" + (f", {unit}" if unit else ""))
    lower.set_ylabel("phase, deg")
    lower.set_xlabel("frequency, Hz" if in_hertz else "angular frequency, rad/s")
    if labels:
        upper.legend()
    return axes


def plot_nyquist(
    *curves: Any, omega: Any = None, axis: Any = None, labels: Any = None, negative: bool = False, **style: Any
) -> Any:
    """Imaginary over real part, with equal scales.

    Parameters
    ----------
    *curves : FrequencyResponse or Model
    omega : array_like, optional
        rad/s, for models.
    axis : matplotlib axes, optional
        Where to draw; a new picture if not given.
    negative : bool
        -Im upwards, as is usual for impedances.

    Returns
    -------
    matplotlib axes

    Examples
    --------
    >>> import fracfit
    >>> fracfit.plot_nyquist(fracfit.Model("1/(s^0.5 + 1)"), omega=[0.1, 1, 10]).get_aspect()
    1.0
    """
    data = _responses(curves, omega)
    if axis is None:
        import matplotlib.pyplot as plt

        _, axis = plt.subplots(constrained_layout=True)
    for (curve, is_model), label in zip(data, labels or [None] * len(data)):
        kind = {"linestyle": "-"} if is_model else {"linestyle": "none", "marker": ".", "markersize": 4}
        imaginary = -curve.response.imag if negative else curve.response.imag
        axis.plot(curve.response.real, imaginary, label=label, **{**kind, **style})
    unit = next((f", {curve.unit}" for curve, _ in data if curve.unit), "")
    axis.set_xlabel("Re" + unit)
    axis.set_ylabel(("-Im" if negative else "Im") + unit)
    axis.set_aspect("equal", adjustable="datalim")
    if labels:
        axis.legend()
    return axis


def plot_fit(result: Any, *, kind: str = "bode", **options: Any) -> Any:
    """Data as points and the fit as a line: kind "bode" or "nyquist"; over time output and fit."""
    data = result.data
    if isinstance(data, TimeSeries):
        import matplotlib.pyplot as plt

        _, axis = plt.subplots(constrained_layout=True)
        axis.plot(data.time, data.output, ".", markersize=4, label="data")
        axis.plot(data.time, result.predict(), "-", label="fit")
        axis.set_xlabel("time, s")
        axis.set_ylabel("output")
        axis.legend()
        return axis
    draw = {"bode": plot_bode, "nyquist": plot_nyquist}.get(kind)
    if draw is None:
        raise ValueError(f"kind is {kind!r}; expected bode or nyquist")
    fine = np.geomspace(data.omega[0], data.omega[-1], 400)
    fitted = FrequencyResponse(fine, result.predict(fine), unit=data.unit)
    return draw(data, _Line(fitted), labels=["data", "fit"], **options)


class _Line:
    """A computed response, which is drawn as a line."""

    def __init__(self, response: FrequencyResponse) -> None:
        self.response = response


def _responses(curves: tuple[Any, ...], omega: Any) -> list[tuple[FrequencyResponse, bool]]:
    if not curves:
        raise ValueError("nothing to draw; expected frequency responses or models")
    measured = [curve.omega for curve in curves if isinstance(curve, FrequencyResponse)]
    if omega is None and measured:
        omega = np.geomspace(min(each[0] for each in measured), max(each[-1] for each in measured), 400)
    found = []
    for curve in curves:
        if isinstance(curve, FrequencyResponse):
            found.append((curve, False))
        elif isinstance(curve, _Line):
            found.append((curve.response, True))
        elif isinstance(curve, Model):
            if omega is None:
                raise ValueError("models need omega, the frequencies to draw them at")
            found.append((curve.frequency_response(omega), True))
        else:
            raise ValueError(f"{type(curve).__name__} cannot be drawn; expected a FrequencyResponse or a Model")
    return found
