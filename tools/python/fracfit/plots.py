# SPDX-License-Identifier: BSD-3-Clause
"""Pictures with matplotlib, which is needed for nothing else."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._data import FrequencyResponse, TimeSeries
from ._doors import response_of
from ._model import Model


def plot_bode(*curves: Any, omega: Any = None, ax: Any = None, labels: Any = None, axes: Any = None, **style: Any) -> Any:
    """Magnitude and phase over frequency: in Hz where all data name theirs so, else in rad/s.

    Parameters
    ----------
    *curves : FrequencyResponse, Model, or the like
        Models are drawn at `omega`, or over the frequencies of the data.
    omega : array_like, optional
        rad/s.
    ax : pair of matplotlib axes, or one, optional
        Where to draw; one takes both, the phase by a scale on its right.  A new picture if not given.
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
    upper, lower = _pair(ax if axes is None else axes)
    measured = [curve for curve, is_model in data if not is_model]
    in_hertz = bool(measured) and all(curve.frequency_unit == "Hz" for curve in measured)
    for (curve, is_model), label in zip(data, _labels(labels, data)):
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
    made = np.empty(2, dtype=object)
    made[:] = upper, lower
    return made


def plot_nyquist(
    *curves: Any, omega: Any = None, ax: Any = None, labels: Any = None, negative: bool | None = None, axis: Any = None, **style: Any
) -> Any:
    """Imaginary over real part, with equal scales.

    Parameters
    ----------
    *curves : FrequencyResponse, Model, or the like
    omega : array_like, optional
        rad/s, for models.
    ax : matplotlib axes, optional
        Where to draw; a new picture if not given.
    negative : bool, optional
        -Im upwards, as is usual for impedances; so by default where the unit is that of an impedance.

    Returns
    -------
    matplotlib axes

    Examples
    --------
    >>> import fracfit
    >>> fracfit.plot_nyquist(fracfit.Model("1/(s^0.5 + 1)"), omega=[0.1, 1, 10]).get_aspect()
    1.0
    >>> impedance = fracfit.FrequencyResponse([1, 2, 3], [3 - 1j, 2 - 1j, 1 - 0.5j], unit="ohm")
    >>> fracfit.plot_nyquist(impedance).get_ylabel()
    '-Im, ohm'
    """
    data = _responses(curves, omega)
    axis = _single(ax if axis is None else axis)
    unit = next((curve.unit for curve, _ in data if curve.unit), "")
    if negative is None:
        negative = is_impedance(unit)
    for (curve, is_model), label in zip(data, _labels(labels, data)):
        kind = {"linestyle": "-"} if is_model else {"linestyle": "none", "marker": ".", "markersize": 4}
        imaginary = -curve.response.imag if negative else curve.response.imag
        axis.plot(curve.response.real, imaginary, label=label, **{**kind, **style})
    axis.set_xlabel("Re" + (f", {unit}" if unit else ""))
    axis.set_ylabel(("-Im" if negative else "Im") + (f", {unit}" if unit else ""))
    axis.set_aspect("equal", adjustable="datalim")
    if labels:
        axis.legend()
    return axis


def is_impedance(unit: str) -> bool:
    """Whether values of this unit are drawn with -Im upwards."""
    return any(each in unit.lower().split("/")[0] for each in ("ohm", "\u03a9", "\u2126"))


def plot_fit(result: Any, *, kind: str = "bode", ax: Any = None, band: bool = True, labels: Any = ("data", "fit"), **options: Any) -> Any:
    """Data as points, the fit as a line, its interval of 95 % as a band.

    Parameters
    ----------
    result : FitResult
    kind : {"bode", "nyquist"}
        Of a frequency response; over time output and fit are drawn.
    ax : matplotlib axes, optional
        Where to draw, as of `plot_bode` and `plot_nyquist`.
    band : bool
        Whether the interval is drawn; over time there is none.
    labels : pair of str, or None
        Of data and fit, for the legend.
    **options
        As of `plot_bode` or `plot_nyquist`; style of matplotlib.
    """
    data = result._with_data()
    if isinstance(data, TimeSeries):
        if kind != "bode" or "omega" in options or "negative" in options:
            wrong = "kind" if kind != "bode" else "omega" if "omega" in options else "negative"
            raise ValueError(f"{wrong} has no meaning with samples over time")
        axis = plot_time(data.time, data.output, ax=options.pop("axis", None) or ax, label=_first(labels, 0), **{"linestyle": "none", "marker": ".", **options})
        axis.plot(data.time, result.predict(), "-", label=_first(labels, 1))
        if labels:
            axis.legend()
        return axis
    draw = {"bode": plot_bode, "nyquist": plot_nyquist}.get(kind)
    if draw is None:
        raise ValueError(f"kind is {kind!r}; expected bode or nyquist")
    fine = np.geomspace(data.omega[0], data.omega[-1], 400)
    fitted = FrequencyResponse(fine, result.predict(fine), unit=data.unit)
    drawn = draw(data, _Line(fitted), labels=labels, ax=ax, **options)
    if band:
        _draw_band(result.band(fine), kind, drawn, data, options)
    return drawn


def _draw_band(band: Any, kind: str, drawn: Any, data: FrequencyResponse, options: dict[str, Any]) -> None:
    if not np.all(np.isfinite(band.re_lower)):
        return  # no interval is known
    if kind == "bode":
        upper, lower = drawn
        axis = band.omega / (2 * np.pi) if data.frequency_unit == "Hz" else band.omega
        upper.fill_between(axis, band.magnitude_lower, band.magnitude_upper, alpha=0.3, color="C1", linewidth=0)
        # That of the line, which jumps nowhere.
        phase = np.unwrap(np.angle(band.response))
        lower.fill_between(axis, *(np.degrees(phase + side * band.phase_half_width) for side in (-1, 1)), alpha=0.3, color="C1", linewidth=0)
        return
    from matplotlib.collections import EllipseCollection

    negative = options.get("negative")
    upwards = -1 if (is_impedance(data.unit) if negative is None else negative) else 1
    centres = np.column_stack([band.response.real, upwards * band.response.imag])
    sizes = band.re_upper - band.re_lower, band.im_upper - band.im_lower
    drawn.add_collection(
        EllipseCollection(*sizes, np.zeros(len(centres)), units="xy", offsets=centres, transOffset=drawn.transData, alpha=0.1, facecolor="C1", edgecolor="none"),
        autolim=False,
    )


def plot_time(time: Any, output: Any, *, ax: Any = None, **style: Any) -> Any:
    """A signal over time."""
    axis = _single(ax)
    axis.plot(time, output, **style)
    axis.set_xlabel("time, s")
    axis.set_ylabel("output")
    return axis


def plot_residuals(validation: Any, *, ax: Any = None, **style: Any) -> Any:
    """What the consistent model leaves of data, in percent, with the band that holds 95 % of the noise."""
    axis = _single(ax)
    data, residuals = validation.data, validation.residuals
    at = data.f if data.frequency_unit == "Hz" else data.omega
    half = 196 * validation.deviation / np.abs(validation.model)
    axis.fill_between(at, -half, half, color="0.8", linewidth=0, label="95 % of noise")
    for part, label in ((residuals.real, "real part"), (residuals.imag, "imaginary part")):
        axis.semilogx(at, 100 * part, label=label, **{"marker": ".", **style})
    axis.set_xlabel("frequency, Hz" if data.frequency_unit == "Hz" else "angular frequency, rad/s")
    axis.set_ylabel("data - model, % of model")
    axis.set_title(validation.validity)
    axis.legend()
    return axis


def plot_times(times: Any, *, ax: Any = None, **style: Any) -> Any:
    """Density over relaxation time, with its range of 95 %, and the areas of lines as points."""
    axis = _single(ax)
    if times.lower.size:
        axis.fill_between(times.tau, times.lower, times.upper, alpha=0.3, linewidth=0)
    axis.semilogx(times.tau, times.density, **style)
    if times.lines:
        axis.semilogx([each["tau"] for each in times.lines], [each["area"] for each in times.lines], "o", label="areas of lines")
        axis.legend()
    axis.set_xlabel("relaxation time, s")
    axis.set_ylabel("density per e-fold" + (f", {times.unit}" if times.unit else ""))
    return axis


class _Line:
    """A computed response, which is drawn as a line."""

    def __init__(self, response: FrequencyResponse) -> None:
        self.response = response


def _single(ax: Any) -> Any:
    if ax is None:
        import matplotlib.pyplot as plt

        return plt.subplots(constrained_layout=True)[1]
    return _checked(np.asarray(ax, dtype=object).reshape(-1)[0])


def _pair(ax: Any) -> tuple[Any, Any]:
    if ax is None:
        import matplotlib.pyplot as plt

        upper, lower = plt.subplots(2, 1, sharex=True, constrained_layout=True)[1]
        return upper, lower
    given = np.asarray(ax, dtype=object).reshape(-1)
    if given.size == 1:
        first = _checked(given[0])
        return first, first.twinx()
    if given.size != 2:
        raise ValueError(f"ax are {given.size} axes; expected two, for magnitude and phase, or one")
    return _checked(given[0]), _checked(given[1])


def _checked(axis: Any) -> Any:
    if not hasattr(axis, "plot") or not hasattr(axis, "set_xlabel"):
        raise ValueError(f"ax is of the type {type(axis).__name__}; expected axes of matplotlib, such as plt.gca()")
    return axis


def _first(labels: Any, index: int) -> Any:
    return None if not labels else labels[index]


def _labels(labels: Any, data: list[Any]) -> list[Any]:
    if not labels:
        return [None] * len(data)
    listed = [labels] if isinstance(labels, str) else list(labels)
    if len(listed) != len(data):
        raise ValueError(f"labels has {len(listed)} entries; expected one for each of the {len(data)} curves")
    return listed


def _responses(curves: tuple[Any, ...], omega: Any) -> list[tuple[FrequencyResponse, bool]]:
    if not curves:
        raise ValueError("nothing to draw; expected frequency responses or models")
    given = [curve if isinstance(curve, (Model, _Line)) else response_of(curve, name="a curve") for curve in curves]
    measured = [curve.omega for curve in given if isinstance(curve, FrequencyResponse)]
    if omega is None and measured:
        omega = np.geomspace(min(each[0] for each in measured), max(each[-1] for each in measured), 400)
    found = []
    for curve in given:
        if isinstance(curve, FrequencyResponse):
            found.append((curve, False))
        elif isinstance(curve, _Line):
            found.append((curve.response, True))
        else:
            if omega is None:
                raise ValueError("models need omega, the frequencies to draw them at")
            found.append((curve.frequency_response(omega), True))
    return found
