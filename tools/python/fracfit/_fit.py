# SPDX-License-Identifier: BSD-3-Clause
"""Fits: one structure, many data, structures against each other, scenes with backlash, controllers."""

from __future__ import annotations

import inspect
import math
import re
import warnings
from functools import cached_property
from typing import TYPE_CHECKING, Any, Callable, Iterable, Iterator, Mapping, Sequence, TypeVar, Union

import numpy as np

from . import _core
from ._arrays import Array, body_of, complex_array, count, flag, mapping, number, pair, real_array, seed_number, text, texts
from ._controller import FractionalPid
from ._data import FrequencyResponse, TimeSeries
from ._doors import data_of, response_of
from ._model import EXACT, Model, realisation_of, _equal, _Record
from ._numbers import FitResultNumbers, IdentificationNumbers, SceneIdentificationNumbers, TuningNumbers
from ._tables import Table
from ._text import escaped, html_table, reporter, short
from ._words import meant, named, no_attribute

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._economy import Economy

try:
    from . import _fitting
except ImportError as reason:
    raise ImportError(f"this installation of fracfit cannot fit: {reason}; it needs its part _fitting, with Ceres and NLopt") from reason

# What would help, in the words of this module.
_REMEDIES = {
    "give-limits": "Others are given by bounds={{{0!r}: (lower, upper)}}.",
    "estimate-trend": "trend=True estimates a drift.",
    "estimate-earlier-input": "earlier_input=True estimates the input before the record.",
    "hold-zero-order": "hold='zero-order' takes the input so.",
    "hold-first-order": "hold='first-order' takes the input so.",
    "hold-band-limited": "hold='band-limited' takes the input so.",
}


_Result = TypeVar("_Result")

# What the compiled part calls the kinds of numbers.
_KINDS = {"flag": "bool", "count": "int", "number": "float", "text": "str", "object": "dict"}


def _described(result: str) -> Callable[[type[_Result]], type[_Result]]:
    """Puts the numbers of a result, as the compiled part describes them, before the attributes in a docstring."""

    def described(made: type[_Result]) -> type[_Result]:
        told = ""
        for name, kind, meaning, entries in _fitting.described[result]:
            meaning = re.sub(", see [a-z-]+", f": {entries}" if entries else "", meaning)
            if not hasattr(made, name):
                told += f"\n{name} : {re.sub('[a-z]+', lambda word: _KINDS.get(word[0].rstrip('s'), word[0]), kind)}"
                told += f"\n    {meaning[0].upper()}{meaning[1:]}."
        # Python from 3.13 on takes the indentation away itself.
        head = "Attributes\n----------"
        made.__doc__ = inspect.cleandoc(made.__doc__ or "").replace(head, head + told, 1)
        return made

    return described


def _with_advice(sentence: str, advice: Sequence[tuple[str, list[str]]]) -> str:
    return " ".join([sentence, *(_REMEDIES[remedy].format(*parameters) for remedy, parameters in advice)])


@_described("FitResult")
class FitResult(Table, FitResultNumbers):
    """A structure fitted to data.

    ``result["a"]`` is the value of a parameter, ``result.parameters`` all of them; numbers a fit cannot tell are NaN.

    Attributes
    ----------
    component : str or None
        Part of a response that was fitted.
    left_out : list of int
        Points that contradict their neighbours on both sides and were not fitted, see the option ``outliers`` of `fit`.
    growth : dict or None
        After ``grow``: the structures tried (fits), which was chosen, and the reason why it went no further.
    law : str or None
        Of the model ``"component-power-law"``: what it says, which its formula does not.
    derived : list of dict
        The quantities that the option ``derive`` of `fit` asked for, as `derive` gives them.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> data = fracfit.Model("2/(0.5 s^0.7 + 1)").frequency_response(np.logspace(-1, 2, 20))
    >>> result = fracfit.fit(data, "K/(T s^a + 1)")
    >>> {name: round(value, 9) for name, value in result.parameters.items()}
    {'K': 2.0, 'T': 0.5, 'a': 0.7}
    >>> result.usable
    True
    """

    def __init__(
        self, values: Mapping[str, Any] | _fitting.Fitted, data: Any = None, options: Mapping[str, Any] | None = None
    ) -> None:
        self._given = values
        self._data = data
        self._options = options or {}
        self.derived: list[dict[str, Any]] = []

    @cached_property
    def _values(self) -> dict[str, Any]:
        # What the compiled part has found becomes a dict when somebody asks: that takes a tenth of a small fit.
        return self._given.as_dict() if isinstance(self._given, _fitting.Fitted) else dict(self._given)

    def __getstate__(self) -> dict[str, Any]:
        return {"_given": self._values, "_data": self._data, "_options": self._options, "derived": self.derived}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._values:
            raise no_attribute(self, name, () if name.startswith("_") else self._values)
        return self._values[name]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._values})

    @property
    def usable(self) -> bool:
        """The search converged."""
        return self._values["termination"] == "converged"

    @property
    def data(self) -> Any:
        """What was given, with the points that were left out."""
        return self._data

    @property
    def parameters(self) -> dict[str, float]:
        """Value of each parameter."""
        return self._each("value")

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each parameter: 0 where fixed, NaN where the data do not tell it."""
        return self._each("standard_error")

    @property
    def ci95(self) -> dict[str, tuple[float, float]]:
        """Interval of 95 % of each parameter."""
        return {p["name"]: (p["ci95_lower"], p["ci95_upper"]) for p in self._values["parameters"]}

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Limits of each parameter that were in force, given or by default; infinite where there is none."""
        return {p["name"]: (p["lower_limit"], p["upper_limit"]) for p in self._values["parameters"]}

    @property
    def message(self) -> str:
        """What became of the search, and what would help."""
        return _with_advice(self._values["message"], self._values["advice"])

    @property
    def identified(self) -> dict[str, bool]:
        """Whether the data tell the parameter."""
        return self._each("identified")

    @property
    def covariance(self) -> Array:
        """Covariance of the parameters."""
        return np.array(self._values["covariance"], dtype=float)

    @property
    def residuals(self) -> Array:
        """Fit minus data at every point, in their unit and without weight; those at `data.omega`, or at the kept samples of `data.time`.

        Points that were left out have theirs too; how many parts the search weighed is `residual_count`.

        Examples
        --------
        >>> import fracfit, numpy as np
        >>> data = fracfit.FrequencyResponse([1.0, 2.0, 4.0], [1.0, 0.7, 0.52j])
        >>> result = fracfit.fit(data, "K/s^a", outliers="keep")
        >>> bool(np.allclose(result.residuals, result.predict() - data.response))
        True
        """
        data = self._with_data()
        if not isinstance(data, TimeSeries):
            return self.predict() - data.response
        difference = self.predict() - data.output
        return difference if data._kept is None else difference[data._kept]

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter as it follows from that of the data; empty where it does not, "1" where it has none."""
        unit = getattr(self._data, "unit", "")
        return dict(zip(self.parameters, _core.parameter_units(self.formula, unit) + [""] * len(self)))

    @property
    def model(self) -> Model:
        """The formula with the values found."""
        names = Model(self.formula).parameter_names
        return Model(self.formula, **{name: value for name, value in self.parameters.items() if name in names})

    def summary(self) -> str:
        """A few lines for a person."""
        lines = _with_advice(_fitting.summary(self._values), self._values["advice"])
        return lines + "\n" + self.law if self.law else lines

    def predict(self, omega: Any = None) -> Array:
        """Fitted values: at frequencies (rad/s, any order), or of a record over time at its own instants."""
        if isinstance(self._data, TimeSeries):
            if omega is not None:
                raise ValueError("a fit over time predicts at the instants of its record; for others see result.model.respond")
            return _fitting.fitted_output(self._data._arrays(), self._request(), self._values)
        omega = self._data.omega if omega is None else real_array(omega, "omega")
        return _fitting.fitted_response(self._values, self._options.get("realisation", EXACT), omega)

    def deviation(self, omega: Any) -> Array:
        """Standard deviation of the response of the fitted model: columns real part, imaginary part, ln of the magnitude, phase (rad)."""
        return _fitting.response_deviation(self._values, self._options.get("realisation", EXACT), real_array(omega, "omega"))

    def band(self, omega: Any = None) -> FitBand:
        """Response of the fit with its interval of 95 % at frequencies (rad/s), by linear propagation of the covariance.

        Examples
        --------
        >>> import fracfit, numpy as np
        >>> noise = np.exp(0.01j * np.arange(20) ** 2)
        >>> exact = fracfit.Model("2/(0.5 s^0.7 + 1)").frequency_response(np.logspace(-1, 2, 20))
        >>> result = fracfit.fit(fracfit.FrequencyResponse(exact.omega, exact.response * noise), "K/(T s^a + 1)", outliers="keep")
        >>> band = result.band([1.0])
        >>> bool(band.re_lower[0] < band.response[0].real < band.re_upper[0])
        True
        """
        data = self._with_data()
        if isinstance(data, TimeSeries) and omega is None:
            raise ValueError("a fit over time has a band at frequencies that are given")
        omega = data.omega if omega is None else np.sort(real_array(omega, "omega"))
        response = _fitting.fitted_response(self._values, self._options.get("realisation", EXACT), omega)
        freedom = self._values["residual_count"] - self._values["free_parameters"]
        half = (_fitting.student_t_95(freedom) if freedom >= 1 else math.nan) * self.deviation(omega)
        return FitBand(
            {
                "omega": omega,
                "response": response,
                "re_lower": response.real - half[:, 0],
                "re_upper": response.real + half[:, 0],
                "im_lower": response.imag - half[:, 1],
                "im_upper": response.imag + half[:, 1],
                "magnitude_lower": np.abs(response) * np.exp(-half[:, 2]),
                "magnitude_upper": np.abs(response) * np.exp(half[:, 2]),
                "phase_half_width": half[:, 3],
            }
        )

    def profile(self, parameter: str) -> tuple[float, float]:
        """Interval of 95 % of a parameter that follows the cost itself; a side without end is infinite.

        Raises
        ------
        RuntimeError
            A refit went below the cost of the result, which is then no minimum.
        """
        if text(parameter, "parameter") not in self.parameters:
            raise ValueError(f"the fit has no parameter {parameter!r}; it has {', '.join(self.parameters)}")
        lower, upper, better = _fitting.profile(self._data_arrays(), self._request(), self._values, parameter)
        if better:
            raise RuntimeError(f"a refit with {parameter} held went below the cost of the result; fit again with another seed")
        return lower, upper

    def bootstrap(self, samples: int = 200, *, threads: int = 0) -> dict[str, tuple[float, float]]:
        """Intervals of 95 % of all parameters from refits to resampled residuals."""
        if self._values["priors"]:
            raise ValueError("bootstrap does not go with a prior, which no residual can resample")
        found = _fitting.bootstrap(self._data_arrays(), self._request(), self._values, count(samples, "samples"), count(threads, "threads"))
        return {p["name"]: (lower, upper) for p, (lower, upper, _) in zip(self._values["parameters"], found)}

    def derive(self, definition: str) -> dict[str, Any]:
        """A quantity computed from the parameters: name, formula, value, standard_error, ci95_lower and ci95_upper.

        Parameters
        ----------
        definition : str
            Such as ``"f1 = (R1 Q1)^(-1/n1)/(2 pi)"``.
        """
        found = _fitting.derive(self._values, text(definition, "definition"))
        if not math.isfinite(found["value"]):
            _warn([f"{found['formula']} is no finite number at the estimates"])
        return found

    def lack_of_fit(self) -> dict[str, Any]:
        """Whether the fit follows the data to within their noise: adequate, misfit, p_value, noise, correlation."""
        return _fitting.lack_of_fit(self._data_arrays(), self._request(), self._values)

    @property
    def weight(self) -> str | None:
        """What residuals were divided by, as of `fit`; of samples over time "given" or "absolute"."""
        if isinstance(self._data, TimeSeries):
            return "absolute" if self._data.sigma is None else "given"
        return self._options.get("weight")

    def plot(self, **options: Any) -> Any:
        """Data and fit in one picture, with matplotlib; see `fracfit.plots.plot_fit`."""
        from .plots import plot_fit

        return plot_fit(self, **options)

    def _columns(self) -> dict[str, Any]:
        columns: dict[str, Any] = {"parameter": list(self.parameters), "unit": list(self.units.values())}
        for key in ("value", "standard_error", "ci95_lower", "ci95_upper", "identified", "at_bound", "fixed"):
            columns[key] = list(self._each(key).values())
        return columns

    def _head(self) -> Mapping[str, str]:
        return {"model": self.formula}

    def points(self) -> FitPoints:
        """Data, fit and residuals side by side, as a table.

        Examples
        --------
        >>> import fracfit, numpy as np
        >>> data = fracfit.Model("2/(0.5 s^0.7 + 1)").frequency_response(np.logspace(-1, 2, 20))
        >>> fracfit.fit(data, "K/(T s^a + 1)").points().residual.shape
        (20,)
        """
        data = self._with_data()
        if isinstance(data, TimeSeries):
            shown = slice(None) if data._kept is None else data._kept
            return FitPoints({"time": data.time[shown], "output": data.output[shown], "fit": self.predict()[shown], "residual": self.residuals})
        left_out = np.zeros(data.size, dtype=bool)
        left_out[self._values.get("left_out", [])] = True
        return FitPoints({"omega": data.omega, "response": data.response, "fit": self.predict(), "residual": self.residuals, "left_out": left_out})

    def _with_data(self) -> Any:
        if self._data is None:
            raise ValueError("this result has no data with it; those of identify() and batch() have them")
        return self._data

    def _each(self, key: str) -> dict[str, Any]:
        return {p["name"]: p[key] for p in self._values["parameters"]}

    def _data_arrays(self) -> dict[str, Any]:
        data = self._with_data()
        left_out = self._values.get("left_out", [])
        if not left_out:
            return data._arrays()  # type: ignore[no-any-return]
        return data[np.delete(np.arange(data.size), left_out)]._arrays()  # type: ignore[no-any-return]

    def _request(self) -> dict[str, Any]:
        made_with = ("component", "constraints", "global_start", "law")
        return {**self._options, **{key: self._values[key] for key in made_with}}

    def __getitem__(self, name: str) -> float:
        values = self.parameters
        if name not in values:
            raise KeyError(f"the fit has no parameter {name!r}; it has {', '.join(values)}") from None
        return values[name]

    def __contains__(self, name: object) -> bool:
        return name in self.parameters

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __len__(self) -> int:
        return len(self._values["parameters"])

    def keys(self) -> list[str]:
        """Names of the parameters, so that ``dict(result)`` has their values."""
        return list(self.parameters)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, FitResult):
            return NotImplemented
        return _equal(self._values, other._values)

    __hash__ = None  # type: ignore[assignment]

    def _rows(self) -> list[tuple[Any, ...]]:
        units = self.units
        return [
            (p["name"], "" if units[p["name"]] == "1" else units[p["name"]], p["value"], p["standard_error"], p["ci95_lower"], p["ci95_upper"], _remark(p))
            for p in self._values["parameters"]
        ]

    def __repr__(self) -> str:
        left_out = self._values.get("left_out", [])
        if not left_out:
            return self.summary()
        at = ", ".join(f"{each:.6g}" for each in self._data._shown(self._data.omega[left_out]))
        name = "f" if self._data.frequency_unit == "Hz" else "omega"
        return self.summary() + f"\nleft out: {name} = {at} {self._data.frequency_unit}"

    def _repr_html_(self) -> str:
        head: list[str] = ["parameter", "unit", "value", "standard error", "from", "to (95 %)", ""]
        rows = [*self._rows(), *((d["name"], "", d["value"], d["standard_error"], d["ci95_lower"], d["ci95_upper"], d["formula"]) for d in self.derived)]
        if self.without_noise:
            head, rows = head[:3], [row[:3] for row in rows]
        headline = f"{self.formula}: rms {short(self.rms)} over {self.residual_count} residuals"
        return html_table(head, rows, headline) + f"<p>{escaped(self.message)}</p>"


class FitPoints(_Record, Table):
    """Data, fit and residuals side by side.

    Attributes
    ----------
    omega, response : ndarray
        rad/s, and the data; over time `time` (s) and `output`.
    fit, residual : ndarray
        Values of the fit, and fit minus data.
    left_out : ndarray of bool
        Points that were not fitted.
    """

    omega: Array
    response: Array
    time: Array
    output: Array
    fit: Array
    residual: Array
    left_out: Array

    def _columns(self) -> dict[str, Any]:
        if "time" in self.__dict__:
            return {"time_s": self.time, "output": self.output, "fit": self.fit, "residual": self.residual}
        columns: dict[str, Any] = {"omega_rad_s": self.omega}
        for name, values in (("", self.response), ("fit_", self.fit), ("residual_", self.residual)):
            columns[name + "re"], columns[name + "im"] = values.real, values.imag
        return {**columns, "left_out": self.left_out}


class FitBand(_Record, Table):
    """Response of a fit with its interval of 95 %.

    Attributes
    ----------
    omega, response : ndarray
        rad/s, and the values of the fit.
    re_lower, re_upper, im_lower, im_upper, magnitude_lower, magnitude_upper : ndarray
        Ends of the intervals of the parts.
    phase_half_width : ndarray
        Half of that of the phase, rad.
    """

    omega: Array
    response: Array
    re_lower: Array
    re_upper: Array
    im_lower: Array
    im_upper: Array
    magnitude_lower: Array
    magnitude_upper: Array
    phase_half_width: Array

    def _columns(self) -> dict[str, Any]:
        return {
            "omega_rad_s": self.omega,
            "re": self.response.real,
            "im": self.response.imag,
            "re_ci95_lower": self.re_lower,
            "re_ci95_upper": self.re_upper,
            "im_ci95_lower": self.im_lower,
            "im_ci95_upper": self.im_upper,
        }


# What is known of parameters: values by name, or the texts of the command line, "K=2".
Known = Union[Mapping[str, float], str, Sequence[str], None]
Limits = Union[Mapping[str, Union["tuple[float | None, float | None]", str]], str, Sequence[str], None]
Priors = Union[Mapping[str, Union[str, "tuple[float, float]"]], str, Sequence[str], None]


@named
def fit(
    data: Any,
    model: Model | str | ArrayLike | None = None,
    structure: Model | str | None = None,
    *,
    grow: str | None = None,
    component: str = "both",
    weight: str | None = None,
    loss: str = "none",
    outliers: str = "leave-out",
    fixed: Known = None,
    bounds: Limits = None,
    start: Known = None,
    prior: Priors = None,
    constraint: str | Sequence[str] = (),
    derive: str | Sequence[str] = (),
    realisation: Mapping[str, Any] | None = None,
    noise_floor: float | None = None,
    loss_scale: float | None = None,
    seed: int = 1,
    global_start: bool = True,
    stable: bool | None = None,
    dead_time: bool | None = None,
    passive: bool = False,
    offset: float | None = None,
    trend: bool = False,
    earlier_input: bool = False,
    noise: str | None = None,
    fix: Known = None,
    bound: Limits = None,
) -> FitResult:
    """Fits the parameters of a structure to a frequency response, or to samples of input and output over time.

    Parameters
    ----------
    data : FrequencyResponse, TimeSeries, or the like
        What is fitted.  Two arrays in place of it, ``fit(f, Z, model)``, are frequencies in Hz and complex values; tables with
        named columns (pandas, a dict of arrays), arrays of xarray and responses of python-control are understood too.
    model : Model or str
        A model, a formula, the name of a preset (see `presets`) or of a family such as ``"rational:1..4"``; or
        ``"component-power-law"``, K omega^b as one part of a response by itself, which no transfer function has.
    grow : {"powers", "denominator", "arcs", "rational", "commensurate", "terms", "elements"}, optional
        Instead of a model a family, grown by a term at a time while the data pay for it.
    component : {"both", "imaginary", "real", "magnitude", "phase", "impedance", "admittance"}
        Part of a response that is fitted; "impedance" and "admittance" are both parts of that one, made of the other where
        the unit of the data is that of the other, and the model is one of it, as is ``result.data``.  Where the real part is 0 at every frequency, "both" is "imaginary", and a
        warning says so.
    weight : {"learned", "relative", "absolute", "given", "smoothed-relative", "log-complex", "repeats"}
        What residuals are divided by; by default "given" where `sigma_is_measured`, else "learned".  Over time the sigma
        of the record counts where it has one.
    loss : {"none", "huber", "cauchy"}
        Robust loss on each residual.
    outliers : {"leave-out", "keep"}
        What becomes of points of a response that contradict their neighbours on both sides; a warning names them.  A
        robust loss keeps them.
    fixed, bounds, start : mapping, optional
        What is known of parameters beforehand; ``bounds={"K": (None, None)}`` lifts the limits of K.  Texts of the command line
        do too, ``bounds="K=0:5"`` or a list of them, and so do its names ``fix`` and ``bound``.
    prior : mapping, optional
        What is known beside a frequency response, as normal distributions: ``{"n1": (0.9, 0.05), "R0": "0.1+-5%"}``,
        value and standard deviation, or a text with a share of the value for a deviation of the logarithm.
    constraint : str or sequence of str
        Parameters of one kind in rising order, ``"Q1<Q2"``.
    derive : str or sequence of str
        Quantities computed from the parameters, ``"f1 = (R1 Q1)^(-1/n1)/(2 pi)"``: ``result.derived`` has them with intervals.
    realisation : mapping, optional
        What stands for the powers of s, see `Model.frequency_response`.
    seed : int
        Of the multi-start; the same seed gives the same result.
    global_start : bool
        False: one local solve from the given starts.
    stable : bool, optional
        Whether the system of a response has no pole right of the imaginary axis: True whatever the data say, None unless
        they speak against it.
    dead_time : bool, optional
        Whether it has a dead time: True as likely as none, False never, None where the data speak for one.
    passive : bool
        The response is an immittance of a passive system, whose real part is nowhere negative.
    offset, trend, earlier_input
        Over time: what the output shows at rest (estimated if None), a drift, an unknown input before the record.
    noise : {"white", "coloured"}, optional
        Over time: coloured noise is of first order, its correlation from sample to sample estimated (``noise_correlation``); white if None.

    Returns
    -------
    FitResult

    Raises
    ------
    ValueError
        A name or number is wrong, or the data do not suffice.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> data = fracfit.Model("2/(0.5 s^0.7 + 1)").frequency_response(np.logspace(-1, 2, 20))
    >>> fracfit.fit(data, "K/(T s^a + 1)", fixed={"K": 2}).standard_errors["K"]
    0.0
    """
    if structure is not None or _is_values(model):
        data, model = data_of(data, model), structure
    elif type(data) is not FrequencyResponse:
        data = data_of(data)
    if (model is None) == (grow is None):
        raise ValueError(
            "give either model, the structure, or grow, the family to grow it in"
            + ("; presets() lists models by name" if model is None else "")
        )
    data, component = _fitted_part(data, component)
    fixed, bounds = _one_of(fixed, fix, "fixed", "fix"), _one_of(bounds, bound, "bounds", "bound")
    if grow is not None and (prior or constraint):
        raise ValueError("prior and constraint do not go with grow, whose parameters the data choose")
    name, starts = ("", {}) if model is None else _structure(model, of_one_part=True)
    options = {
        "grow": None if grow is None else text(grow, "grow"),
        "component": component,
        "weight": weight_of(weight, [data]),
        "loss": loss,
        "outliers": outliers,
        "realisation": realisation_of(realisation),
        "noise_floor": noise_floor,
        "loss_scale": loss_scale,
        "seed": seed_number(seed),
        "global_start": global_start,
        "stable": stable,
        "dead_time": dead_time,
        "passive": passive,
        "offset": offset,
        "trend": trend,
        "earlier_input": earlier_input,
        "noise": noise,
        "without_noise": without_noise([data]),
        **_known(starts, fixed, bounds, start, prior, constraint),
    }
    _refuse_idle(data, options, fit)
    definitions = texts(derive, "derive") if derive != () else ()
    if isinstance(data, TimeSeries):
        result = FitResult(_fitting.fit_record(data._arrays(), name, options), data, options)
    else:
        found = _fitting.fit_spectrum(data._arrays(), name, options)
        _warn(found.notes(), 4)
        result = FitResult(found, data, options)
    for definition in definitions:
        result.derived.append(result.derive(definition))
    return result


def weight_of(given: str | None, data: Sequence[FrequencyResponse | TimeSeries], otherwise: str = "learned") -> str:
    """The weight that is told, else that of a sigma that was measured in all responses."""
    responses = [each for each in data if isinstance(each, FrequencyResponse)]
    measured = bool(responses) and all(each.sigma_is_measured for each in responses)
    return text(given, "weight") if given is not None else "given" if measured else otherwise


def without_noise(data: Sequence[FrequencyResponse | TimeSeries]) -> bool:
    """Whether all are responses that were computed."""
    return all(isinstance(each, FrequencyResponse) and each.is_computed for each in data)


def _fitted_part(data: Any, component: Any) -> tuple[Any, Any]:
    """Data and component, where that is an impedance or admittance both parts of it."""
    if component not in ("impedance", "admittance") or not isinstance(data, FrequencyResponse):
        return data, component
    return data._as_immittance(component), "both"


def _is_values(given: Any) -> bool:
    """Whether the second argument is an array, and the first one its frequencies."""
    return given is not None and not isinstance(given, (str, Model)) and (hasattr(given, "__array__") or isinstance(given, (list, tuple)))


def _one_of(given: Any, by_command_line: Any, name: str, other: str) -> Any:
    if by_command_line is None:
        return given
    if given is not None:
        raise ValueError(f"{name} and {other} are the same; give one of them")
    return by_command_line


# Options that mean something for one kind of data alone.
_OF_RESPONSES = ("component", "weight", "realisation", "noise_floor", "stable", "dead_time", "passive")
_OF_RECORDS = ("offset", "trend", "earlier_input", "noise")


def _refuse_idle(data: Any, options: Mapping[str, Any], function: Any) -> None:
    over_time = isinstance(data, TimeSeries)
    # A record is weighted so in any case.
    idle_weights = ("absolute" if data.sigma is None else "given",) if over_time else ()
    for name in _OF_RESPONSES if over_time else _OF_RECORDS:
        defaults = {"realisation": EXACT, "weight": "learned"}
        default = defaults[name] if name in defaults else function.__kwdefaults__.get(name)
        if options.get(name) != default and options[name] not in idle_weights:
            kind = "samples over time" if over_time else "a frequency response"
            raise ValueError(f"{name} = {options[name]!r} has no meaning with {kind}")


class BatchResult(Sequence[Any], Table):
    """Fits of one structure to many data; a list of `FitResult`, with None where there is none.

    Attributes
    ----------
    results : list of FitResult or None
        One for each of the data.
    errors : dict of int to str
        Why there is none, by index.
    """

    def __init__(self, results: list[FitResult | None], errors: dict[int, str]) -> None:
        self.results = results
        self.errors = errors

    @property
    def parameters(self) -> dict[str, Array]:
        """Values of each parameter over all data, NaN where there is none."""
        return self._over_data("parameters")

    @property
    def standard_errors(self) -> dict[str, Array]:
        """Standard errors likewise."""
        return self._over_data("standard_errors")

    @property
    def usable(self) -> Array:
        """Which fits converged."""
        return np.array([result is not None and result.usable for result in self.results])

    def _over_data(self, attribute: str) -> dict[str, Array]:
        columns: dict[str, Array] = {}
        for i, result in enumerate(self.results):
            for name, value in (getattr(result, attribute) if result is not None else {}).items():
                columns.setdefault(name, np.full(len(self.results), math.nan))[i] = value
        return columns

    def __getitem__(self, index: Any) -> Any:
        return self.results[index]

    def __len__(self) -> int:
        return len(self.results)

    def _columns(self) -> dict[str, Any]:
        columns: dict[str, Any] = {"index": np.arange(len(self))}
        errors = self.standard_errors
        for name, values in self.parameters.items():
            columns[name], columns[f"{name}_standard_error"] = values, errors[name]
        return {**columns, "usable": self.usable}

    def __repr__(self) -> str:
        return f"BatchResult({len(self)} fits, {int(self.usable.sum())} usable, {len(self.errors)} without a result)"

    def _repr_html_(self) -> str:
        columns = self.parameters
        rows = [(i, *(column[i] for column in columns.values())) for i in range(min(len(self), 50))]
        return html_table(["", *columns], rows, repr(self))


@named
def batch(
    data: Sequence[FrequencyResponse],
    model: Model | str,
    *,
    threads: int = 0,
    progress: Any = None,
    **options: Any,
) -> BatchResult:
    """Fits one structure to each of many frequency responses, in parallel.

    The ``left_out`` of each result says what of its points was not fitted, without a warning.

    Parameters
    ----------
    data : sequence of FrequencyResponse
        One fit for each.
    model : Model or str
        As of `fit`.
    threads : int
        0 for one per core; no influence on results.
    progress : bool or function of (done, total), optional
        A bar, or who is told instead.
    **options
        As of `fit`.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> omega = np.logspace(-1, 2, 20)
    >>> curves = [fracfit.Model("K/(0.5 s^0.7 + 1)", K=k).frequency_response(omega) for k in (1, 2)]
    >>> fracfit.batch(curves, "K/(T s^a + 1)").parameters["K"].round(9)
    array([1., 2.])
    """
    curves = _curves(data)
    name, starts = _structure(model, of_one_part=True)
    known = ("component", "weight", "loss", "outliers", "realisation", "noise_floor", "loss_scale", "seed", "global_start")
    beforehand = ("fixed", "bounds", "start", "prior", "constraint")
    request: dict[str, Any] = {"realisation": EXACT}
    for name_here, name_there in (("fixed", "fix"), ("bounds", "bound")):
        if name_there in options:
            options[name_here] = _one_of(options.get(name_here), options.pop(name_there), name_here, name_there)
    for key, value in options.items():
        if key not in (*known, *beforehand):
            raise TypeError(f"batch() has no argument {key!r}{meant(key, (*known, *beforehand))}; as of fit it takes {', '.join((*known, *beforehand))}")
        request[key] = realisation_of(value) if key == "realisation" else value
    if "component" in request:
        component = request["component"]
        curves = [_fitted_part(curve, component)[0] for curve in curves]
        request["component"] = "both" if component in ("impedance", "admittance") else component
    request["weight"] = weight_of(request.get("weight"), curves)
    request["without_noise"] = without_noise(curves)
    request.update(_known(starts, *(options.get(key) for key in beforehand)))
    found = _fitting.fit_many([curve._arrays() for curve in curves], name, request, count(threads, "threads"), reporter(progress, "batch"))
    errors = {i: each for i, each in enumerate(found) if isinstance(each, str)}
    results = [None if isinstance(each, str) else FitResult(each, curve, request) for each, curve in zip(found, curves)]
    return BatchResult(results, errors)


@_described("Identification")
class Identification(_Record, IdentificationNumbers, Table):
    """Structures ranked on the same data, and what the data say of fractional orders.

    Attributes
    ----------
    chosen : int
        Index of the simplest that is as good as the best.
    next_measurement : tuple or None
        Where undecided, what would decide: from and to (rad/s), and how many points.
    next_accuracy, next_evidence : float or None
        Of that measurement: standard deviation of a weighted residual that it needs, and the evidence to expect.
    distribution : dict or None
        Where whole orders do not explain the data, the distribution of relaxation times that a fractional power was compared with:
        model (in words), parameters, relative_rms, and evidence for the power against it.
    advice : list of tuple
        Of the verdict: what would help, as the sentence says it, and the parameters concerned.
    left_out : list of int
        Points that contradict their neighbours on both sides and were left out.
    component : str or None
        Part of a response that was fitted.
    without_noise : bool
        The data are computed ones, by their metadata or since a model meets them to 1e-9: odds and intervals mean nothing
        there, and `economy` is what they answer.
    usable : bool
    """

    chosen: int
    summary: str
    usable: bool
    next_measurement: tuple[float, float, int] | None
    next_accuracy: float | None
    next_evidence: float | None
    distribution: dict[str, Any] | None
    advice: list[tuple[str, list[str]]]
    left_out: list[int]
    component: str | None
    without_noise: bool
    _of: dict[str, Any]
    _economy: Economy

    @property
    def best(self) -> FitResult:
        """The chosen fit."""
        return self.ranking[self.chosen]["fit"]  # type: ignore[no-any-return]

    def _columns(self) -> dict[str, Any]:
        columns: dict[str, Any] = {"model": [each["name"] for each in self.ranking]}
        for name in ("model_class", "delta_aicc", "akaike_weight", "adequate"):
            columns[name] = [each[name] for each in self.ranking]
        return {**columns, "free_parameters": [each["fit"].free_parameters for each in self.ranking], "rms": [each["fit"].rms for each in self.ranking]}

    @property
    def economy(self) -> Economy | None:
        """Of data without noise how many parameters each class of models needs, see `fracfit.economy`; else None.

        It takes some seconds of processor time, when it is first asked for.

        Raises
        ------
        ValueError
            The component that was fitted is none of both, imaginary and real, or is 0 at a point.
        """
        if not self.without_noise:
            return None
        if not hasattr(self, "_economy"):
            from ._economy import economy

            self._economy = economy(**self._of)
        return self._economy

    def __repr__(self) -> str:
        if not self.without_noise:
            return self.summary
        return self.summary + " `economy` says it."

    def _repr_html_(self) -> str:
        if self.without_noise:
            plain = [(each["name"], each["model_class"], each["fit"].rms, "chosen" if i == self.chosen else "") for i, each in enumerate(self.ranking)]
            return html_table(["model", "class", "rms", ""], plain, repr(self))
        rows = []
        for i, each in enumerate(self.ranking):
            remark = "chosen" if i == self.chosen else "" if each["adequate"] else "misses the data"
            rows.append((each["name"], each["model_class"], each["delta_aicc"], each["akaike_weight"], each["fit"].rms, remark))
        return html_table(["model", "class", "delta AICc", "weight", "rms", ""], rows, self.verdict_sentence)


@named
def identify(
    data: FrequencyResponse | TimeSeries,
    models: Sequence[Model | str] = (),
    *,
    curves: Mapping[str, Any] | None = None,
    threads: int = 0,
    component: str = "both",
    weight: str | None = None,
    loss: str = "none",
    outliers: str = "leave-out",
    realisation: Mapping[str, Any] | None = None,
    seed: int = 1,
    stable: bool | None = None,
    dead_time: bool | None = None,
    passive: bool = False,
    offset: float | None = None,
    trend: bool = False,
    earlier_input: bool = False,
    noise: str | None = None,
    bounds: Limits = None,
    folds: int | None = None,
    bound: Limits = None,
) -> Identification:
    """Ranks structures on data and says whether they speak for a fractional order.

    Parameters
    ----------
    data : FrequencyResponse or TimeSeries
        What is to be explained.
    models : sequence of Model or str
        Formulas, presets and families such as ``"rational:1..8"``; all presets and families if empty.
    curves : mapping of str to array_like, optional
        Further candidates given by their values at the frequencies of the data.
    bounds : mapping, optional
        Limits of every candidate that is a preset or a formula and has the parameter.
    folds : int, optional
        Cross-validates each candidate: predicts each of so many blocks of neighbouring points from the others;
        ``prediction_rms`` of each in the ranking.
    component, weight, loss, outliers, ...
        As of `fit`.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> data = fracfit.Model("2/(0.5 s^0.7 + 1)").frequency_response(np.logspace(-1, 2, 20))
    >>> fracfit.identify(data, ["fractional-lag", "lag"]).ranking[0]["name"]
    'fractional-lag'
    """
    data, component = _fitted_part(data_of(data), component)
    if isinstance(models, str):
        # As the command line separates them; no formula has a comma.
        models = [each.strip() for each in models.split(",")]
    names = [_structure(each)[0] for each in ([models] if isinstance(models, Model) or not isinstance(models, Iterable) else models)]
    options = {
        "component": component,
        "weight": weight_of(weight, [data]),
        "loss": loss,
        "outliers": outliers,
        "realisation": realisation_of(realisation),
        "seed": seed_number(seed),
        "stable": stable,
        "dead_time": dead_time,
        "passive": passive,
        "offset": offset,
        "trend": trend,
        "earlier_input": earlier_input,
        "noise": noise,
        "without_noise": without_noise([data]),
    }
    _refuse_idle(data, options, identify)
    options |= {"bounds": _ranges(_by_name(_one_of(bounds, bound, "bounds", "bound"), "bounds", "NAME=LOW:HIGH") or {})}
    options |= {"folds": None if folds is None else count(folds, "folds")}
    given = {name: complex_array(value, name) for name, value in mapping(curves or {}, "curves").items()}
    found = _fitting.identify(data._arrays(), names, given, options, count(threads, "threads"))
    _warn(found.pop("said"), 4)
    for each in ("verdict_sentence", "summary"):
        found[each] = _with_advice(found[each], found["advice"])
    for each in found["ranking"]:
        each["fit"]["left_out"] = found["left_out"]
        each["fit"]["component"] = found["component"]
        each["fit"]["growth"] = each["fit"]["law"] = None
        each["fit"]["constraints"] = each.pop("constraints")
        each["fit"]["global_start"] = not each["from_family"]
        each["fit"] = FitResult(each["fit"], data, options)
    if isinstance(data, FrequencyResponse):
        kept = np.delete(np.arange(data.size), found["left_out"])
        found["_of"] = {
            "data": data[kept],
            "curves": {name: value[kept] for name, value in given.items()},
            "component": component,
            "threads": threads,
        }
    return Identification(found)


@_described("Tuning")
class Tuning(_Record, TuningNumbers):
    """A controller found for a plant: gains kp, ki, kd, orders lambda_ and mu, and what its loop reaches.

    Attributes
    ----------
    usable : bool
        The closed loop is stable and the whole specification kept, for a fit by all plants that its data leave possible.
    specification : list of tuple
        Name, asked, reached, met.
    controller : str
        Its formula.
    region : dict
        For a fit the worst of the plants of its joint 95 % region: plants, not_stable, max_sensitivity,
        max_complementary_sensitivity, least_phase_margin, lowest_crossover, highest_crossover, status and message.
    plant : str
        For a record of a relay experiment the formula of the plant that explains it best.
    motion, motion_regardless, regardless, constraints
        With a clearance the motion that persists (swing in m, omega, verified, cycles, simulations), that with the controller
        which regards no clearance, that controller, and what holds the answer where it is.
    """

    usable: bool
    summary: str
    specification: list[tuple[str, float, float, bool]]
    controller: str
    plant: str
    region: dict[str, Any]
    motion: dict[str, Any]
    motion_regardless: dict[str, Any]
    regardless: dict[str, Any]
    constraints: list[dict[str, Any]]

    @property
    def model(self) -> Model:
        """The controller as a transfer function."""
        return Model(self.controller)

    def pid(self, sample_time: float, band: tuple[float, float] | None = None, **options: Any) -> FractionalPid:
        """The controller as it runs in a loop; options as of `FractionalPid`."""
        gains = {name: getattr(self, name) for name in ("kp", "ki", "kd", "lambda_", "mu", "derivative_filter_time")}
        return FractionalPid(**gains, sample_time=sample_time, band=band, **options)

    def __repr__(self) -> str:
        return self.summary

    def _repr_html_(self) -> str:
        rows = [(name, asked, reached, "yes" if met else "no") for name, asked, reached, met in self.specification]
        gains = ", ".join(f"{name} = {short(getattr(self, name))}" for name in ("kp", "ki", "kd", "lambda_", "mu"))
        return html_table(["asked for", "value", "reached", "kept"], rows, gains) + f"<p>{escaped(self.message)}</p>"


@named
def tune(
    plant: Model | FitResult | str | None = None,
    *,
    crossover: float | None = None,
    phase_margin: float | None = None,
    flat_phase: bool = False,
    max_sensitivity: float = math.inf,
    max_complementary_sensitivity: float = math.inf,
    high_frequency: tuple[float, float] | None = None,
    low_frequency: tuple[float, float] | None = None,
    structure: str = "pid",
    lambda_: float | tuple[float, float] = (0.1, 1.9),
    mu: float | tuple[float, float] = (0.1, 1.9),
    derivative_filter_time: float = 0.0,
    minimise: str = "sensitivity",
    load_step: bool = False,
    horizon: float = 0.0,
    seed: int = 1,
    clearance: float | None = None,
    restitution: float | None = None,
    mass1: float | None = None,
    mass2: float | None = None,
    load_receptance: Model | str | None = None,
    drive_receptance: Model | str | None = None,
    contact_stiffness: float | None = None,
    contact_damping: float | None = None,
    friction1: float | None = None,
    friction2: float | None = None,
    body: str = "x1",
    from_relay: TimeSeries | Any = None,
) -> Tuning:
    """Gains and orders of a fractional PID for a plant.

    Parameters
    ----------
    plant : Model, FitResult or str
        A model, or its formula; of a fit all plants of the joint 95 % region of its parameters keep the bounds on ``|S|`` and ``|T|``.
        Left out where `clearance` makes the plant two bodies with backlash.
    crossover : float, optional
        rad/s where ``|L| = 1``.
    phase_margin : float, optional
        rad, there.
    flat_phase : bool
        No slope of the phase there.
    max_sensitivity, max_complementary_sensitivity : float
        Largest ``|S|`` and ``|T|``.
    high_frequency, low_frequency : (float, float), optional
        (omega, gain): ``|T| <= gain`` from omega on; ``|S| <= gain`` up to omega.
    structure : {"pid", "pi", "pd", "series"}
        Which parts the controller has.
    lambda_, mu : float or (float, float)
        Orders, held or within a range.
    minimise : {"sensitivity", "iae", "itae"}
        The integrals are of a step response of length `horizon` (s).
    clearance, restitution, mass1, mass2, load_receptance, drive_receptance, body, contact_stiffness, contact_damping, friction1, friction2
        Two bodies with backlash, as of `limit_cycles`: no motion is to persist, or the smallest.
    from_relay : TimeSeries, optional
        In place of a plant samples of input and output of a relay experiment or any other: a lag, a fractional lag, a second
        order, three equal lags or an integrator with lag, each with dead time, whichever explains them best; then as a fit.

    Examples
    --------
    >>> import fracfit, math
    >>> found = fracfit.tune("1/(s^1.5 + s)", crossover=1.0, phase_margin=math.radians(60), structure="pi")
    >>> found.usable, round(math.degrees(found.phase_margin), 6)
    (True, 60.0)
    """
    if sum(each is not None for each in (plant, clearance, from_relay)) != 1:
        raise ValueError("give one of plant, a model or a fit, of from_relay, a record, and of clearance, of two bodies that are the plant")
    if clearance is None:
        of_bodies = {
            "restitution": restitution,
            "mass1": mass1,
            "mass2": mass2,
            "load_receptance": load_receptance,
            "drive_receptance": drive_receptance,
            "contact_stiffness": contact_stiffness,
            "contact_damping": contact_damping,
            "friction1": friction1,
            "friction2": friction2,
            "body": None if body == "x1" else body,
        }
        for name, value in of_bodies.items():
            if value is not None:
                raise ValueError(f"{name} has no meaning without clearance, of two bodies that are the plant")
    specification = {
        "crossover": None if crossover is None else number(crossover, "crossover"),
        "phase_margin": None if phase_margin is None else number(phase_margin, "phase_margin"),
        "flat_phase": flag(flat_phase, "flat_phase"),
        "max_sensitivity": number(max_sensitivity, "max_sensitivity"),
        "max_complementary_sensitivity": number(max_complementary_sensitivity, "max_complementary_sensitivity"),
        "high_frequency": None if high_frequency is None else pair(high_frequency, "high_frequency"),
        "low_frequency": None if low_frequency is None else pair(low_frequency, "low_frequency"),
    }
    options = {
        "structure": text(structure, "structure"),
        "lambda_": _range(lambda_, "lambda_"),
        "mu": _range(mu, "mu"),
        "derivative_filter_time": number(derivative_filter_time, "derivative_filter_time"),
        "minimise": text(minimise, "minimise"),
        "load_step": flag(load_step, "load_step"),
        "horizon": number(horizon, "horizon"),
        "seed": seed_number(seed),
    }
    if clearance is not None:
        from ._backlash import _bodies, contacts_of

        contact = contacts_of(restitution, contact_stiffness, contact_damping, friction1, friction2)
        bodies = _bodies(restitution, clearance, mass1, mass2, load_receptance, drive_receptance, body, contact)
        return Tuning(_fitting.tune_with_backlash(bodies, specification, options))
    if from_relay is not None:
        record = data_of(from_relay, name="from_relay")
        if not isinstance(record, TimeSeries):
            raise ValueError(f"from_relay is of the type {type(record).__name__}; expected a TimeSeries, samples of input and output")
        return Tuning(_fitting.tune_from_relay(record._arrays(), specification, options))
    if isinstance(plant, (FrequencyResponse, TimeSeries)):
        raise ValueError(f"plant is of the type {type(plant).__name__}; fit a model to it, and give the result: its region is kept in mind")
    if isinstance(plant, FitResult):
        return Tuning(_fitting.tune_for_region(plant._values, specification, options))
    model = plant if isinstance(plant, Model) else Model(plant)
    return Tuning(_fitting.tune(model._tf, specification, options))


@_described("SceneIdentification")
class SceneIdentification(_Record, SceneIdentificationNumbers, Table):
    """Masses, clearance and restitution from measured describing functions.

    Attributes
    ----------
    curve, omega, used, response : ndarray
        Of each point: which curve it is of, its frequency, whether it was used, and the fitted value.
    usable : bool
    """

    curve: Array
    omega: Array
    used: Array
    response: Array
    usable: bool

    def _columns(self) -> dict[str, Any]:
        names = ("name", "unit", "value", "standard_error", "ci95_lower", "ci95_upper", "identified", "at_bound", "fixed")
        return {name: [each[name] for each in (*self.parameters, *self.combinations, *self.contact, *self.friction)] for name in names}

    def __getitem__(self, name: str) -> float:
        for each in (*self.parameters, *self.combinations, *self.contact, *self.friction):
            if each["name"] == name:
                return each["value"]
        raise KeyError(f"a scene has no quantity {name}")

    def __repr__(self) -> str:
        lines = [f"  {each['name']} = {short(each['value'])} {each['unit']} +- {short(each['standard_error'])}" for each in self.parameters]
        return "\n".join(["SceneIdentification:", *lines, *self.free_directions, self.message])

    def _repr_html_(self) -> str:
        rows = [
            (each["name"], each["unit"], each["value"], each["standard_error"], each["ci95_lower"], each["ci95_upper"])
            for each in (*self.parameters, *self.combinations, *self.contact, *self.friction)
        ]
        return html_table(["", "unit", "value", "standard error", "from", "to (95 %)"], rows, self.message)


@named
def identify_scene(
    curves: Sequence[FrequencyResponse],
    force: Any,
    *,
    harmonic: Any = 1,
    fixed: Known = None,
    bounds: Limits = None,
    body: str = "x1",
    component: str = "both",
    weight: str | None = None,
    contact: str = "auto",
    friction: str = "none",
    load_receptance: Model | str | None = None,
    drive_receptance: Model | str | None = None,
    threads: int = 0,
    fix: Known = None,
    bound: Limits = None,
) -> SceneIdentification:
    """Estimates masses, clearance and restitution from describing functions of two masses with backlash.

    Parameters
    ----------
    curves : sequence of FrequencyResponse
        N in m/N, one for each force amplitude.
    force : array_like
        Those amplitudes, N.
    harmonic : array_like
        Which harmonic each curve is, 1, 3 or 5; one for all or one for each.  At least one is the fundamental.
    fixed, bounds : mapping, optional
        Of mass1, mass2 (kg), clearance (m), restitution, contact_time (s), friction1 and friction2 (N).  From x1 one mass or the clearance has to be fixed.
    body : {"x1", "x2"}
        Whose position was measured.
    component : {"both", "real", "imaginary"}
        Part that is fitted.
    weight : {"relative", "given", "absolute"}
        What residuals are divided by; by default "given" where the sigma of all curves was measured, else "relative".
    contact : {"auto", "hard", "compliant"}
        Hard contacts take no time; the others have a stiffness and a damping, which are estimated.  The intervals of
        "auto" hold for both.
    friction : {"none", "auto", "estimate"}
        Dry friction of both masses: taken for none, estimated where the data tell it from none, or estimated always.
    load_receptance, drive_receptance : Model or str, optional
        Displacement per force of body 1 and 2, m/N, with names to estimate, such as "1/(m1 s^2 + b1 s)", instead of free
        masses; `fixed` and `bounds` take these names, values of a Model are starts, contacts are hard then.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> omega = np.linspace(15, 35, 21)
    >>> curves = [fracfit.describing_function(omega, restitution=0.6, force=f, clearance=0.3).data() for f in (20, 40)]
    >>> found = fracfit.identify_scene(curves, [20, 40], fixed={"mass1": 1})
    >>> round(found["restitution"], 6), round(found["clearance"], 6)
    (0.6, 0.3)
    """
    curves = [curves] if isinstance(curves, FrequencyResponse) else _curves(curves)
    forces = real_array(np.atleast_1d(force), "force")
    if forces.size != len(curves):
        raise ValueError(f"force has {forces.size} entries for {len(curves)} curves")
    for i, curve in enumerate(curves):
        if curve.unit.lower() not in ("", "m/n", "m_per_n"):
            raise ValueError(f"curves[{i}] has values in {curve.unit}; expected a motion over a force, in m/N")
    orders = real_array(np.atleast_1d(harmonic), "harmonic")
    if orders.size not in (1, len(curves)) or not np.isin(orders, (1, 3, 5)).all():
        raise ValueError(f"harmonic is {harmonic!r} for {len(curves)} curves; expected 1, 3 or 5, one for all or one for each")
    chosen = weight_of(weight, curves, "relative")
    receptances, starts = {"load_receptance": "", "drive_receptance": ""}, {}
    for name, given in (("load_receptance", load_receptance), ("drive_receptance", drive_receptance)):
        if given is not None:
            model = given if isinstance(given, Model) else Model(given)
            receptances[name] = model.formula
            starts.update(model.parameters)
    if any(receptances.values()) and (contact == "compliant" or friction != "none"):
        wrong = "contact" if contact == "compliant" else "friction"
        raise ValueError(f"{wrong} has no meaning with receptances, which know hard contacts and viscous friction only")
    request = {
        **receptances,
        **_known(starts, _one_of(fixed, fix, "fixed", "fix"), _one_of(bounds, bound, "bounds", "bound"), None, None, ()),
        "harmonic": np.broadcast_to(orders, len(curves)).astype(int).tolist(),
        "body": body_of(body),
        "component": text(component, "component"),
        "weight": text(chosen, "weight"),
        "sigma_is_measured": chosen == "given" and all(curve.sigma_is_measured for curve in curves),
        "contact": text(contact, "contact"),
        "friction": text(friction, "friction"),
        "threads": count(threads, "threads"),
    }
    return SceneIdentification(_fitting.identify_scene([curve._arrays() for curve in curves], forces.tolist(), request))


class CustomCircuit:
    """A circuit fitted to an impedance, in the manner of impedance.py; frequencies are in Hz.

    Parameters
    ----------
    circuit : str
        A formula of s such as ``"R0 + R1/(1 + R1 Q1 s^n1)"``, or the name of a preset.
    initial_guess : mapping of str to float, or sequence of float, optional
        Starts of some parameters by name, or of all in order of appearance; none is needed.
    **options
        As of `fit`.

    Examples
    --------
    >>> import numpy as np
    >>> from fracfit import CustomCircuit, Model
    >>> f = np.logspace(-2, 4, 40)
    >>> Z = Model("0.02 + 0.03/(1 + 0.03*0.5 s^0.85)")(2j * np.pi * f)
    >>> circuit = CustomCircuit("R0 + R1/(1 + R1 Q1 s^n1)").fit(f, Z)
    >>> [round(value, 9) for value in circuit.parameters_]
    [0.02, 0.03, 0.5, 0.85]
    >>> bool(np.allclose(circuit.predict(f), Z))
    True
    """

    def __init__(
        self, circuit: str, initial_guess: Mapping[str, float] | Sequence[float] | None = None, **options: Any
    ) -> None:
        _structure(circuit)
        self.circuit = circuit
        if initial_guess is None or isinstance(initial_guess, Mapping):
            self.initial_guess = dict(initial_guess or {})
        else:
            names = Model(presets().get(circuit, circuit)).parameter_names
            starts = real_array(initial_guess, "initial_guess")
            if len(starts) != len(names):
                raise ValueError(f"initial_guess has {len(starts)} entries; expected those of {', '.join(names)}")
            self.initial_guess = dict(zip(names, starts.tolist()))
        self.options = options
        self.result_: FitResult | None = None

    def fit(self, frequencies: Any, impedance: Any, sigma: Any = None, **options: Any) -> CustomCircuit:
        """Fits the circuit and returns it; options as of `fracfit.fit`."""
        data = FrequencyResponse.from_hz(frequencies, impedance, sigma, unit="ohm")
        self.result_ = fit(data, self.circuit, **{"start": self.initial_guess, **self.options, **options})
        return self

    def _fitted(self) -> FitResult:
        if self.result_ is None:
            raise RuntimeError("the circuit has not been fitted; call fit(f, Z) first")
        return self.result_

    @property
    def parameters_(self) -> Array:
        """Values, in order of appearance."""
        return np.array(list(self._fitted().parameters.values()))

    @property
    def conf_(self) -> Array:
        """Standard errors."""
        return np.array(list(self._fitted().standard_errors.values()))

    def get_param_names(self) -> list[str]:
        """Names, in order of appearance."""
        return list(self._fitted().parameters)

    def predict(self, frequencies: Any) -> Array:
        """Impedance at frequencies in Hz, in any order."""
        return self._fitted().predict(2 * np.pi * real_array(frequencies, "frequencies"))

    def plot(self, **options: Any) -> Any:
        """Data and fit in a Nyquist diagram of the impedance, -Im upwards."""
        return self._fitted().plot(**{"kind": "nyquist", "negative": True, **options})

    def __repr__(self) -> str:
        return f"CustomCircuit({self.circuit!r})" + ("" if self.result_ is None else f"\n{self.result_!r}")


def presets() -> dict[str, str]:
    """Formulas of the model library by name.

    Examples
    --------
    >>> import fracfit
    >>> fracfit.presets()["power-law"]
    'K s^a'
    """
    return {name: formula for name, formula, _ in _fitting.presets()}


def _curves(given: Any) -> list[FrequencyResponse]:
    if not isinstance(given, Iterable) or isinstance(given, (FrequencyResponse, str, Mapping)) or hasattr(given, "columns"):
        raise ValueError(f"data are of the type {type(given).__name__}; expected a sequence of FrequencyResponse")
    return [response_of(curve, name=f"data[{i}]") for i, curve in enumerate(given)]


def _warn(notes: Sequence[str], level: int = 3) -> None:
    for note in notes:
        warnings.warn(note, stacklevel=level)


# Formulas of one parameter, which nobody means.
_WORD = re.compile("[a-z][a-z_-]{3,}")


# Elements side by side, "p(R1,C1)", or with numbers behind an underscore, "R_1-p(...)".
_CIRCUIT_STRING = re.compile(r"(?<![A-Za-z0-9_])p\([^()]*,")

_LAW_OF_ONE_PART = "component-power-law"


def _structure(model: Model | str, *, of_one_part: bool = False) -> tuple[str, dict[str, float]]:
    if isinstance(model, Model):
        return model.formula, model.parameters
    if not isinstance(model, str):
        raise ValueError(
            f"model is of the type {type(model).__name__}; expected a Model, a formula or the name of a preset; Model(system) is that of another package"
        )
    if _CIRCUIT_STRING.search(model):
        raise ValueError(f"model {model!r} is a circuit string of impedance.py; write it as a formula of s, such as R0 + R1/(1 + R1 C1 s), or name a preset")
    if not _WORD.fullmatch(model):
        return model, {}
    if model == _LAW_OF_ONE_PART and not of_one_part:
        raise ValueError(f"model {model!r} is one of fit and batch, which fit one part of a response by itself")
    known = [*presets(), "rational", "commensurate", "terms", "elements", _LAW_OF_ONE_PART]
    if model not in known:
        raise ValueError(f"model {model!r} is neither a preset nor a formula of s{meant(model.replace('_', '-'), known)}; presets() lists the names")
    return model, {}


def _by_name(given: Any, what: str, expected: str) -> Any:
    """Texts of the command line, NAME=VALUE, as a mapping."""
    if given is None or isinstance(given, (dict, Mapping)):
        return given
    texts = [given] if isinstance(given, str) else given
    if not isinstance(texts, (list, tuple)) or not all(isinstance(each, str) for each in texts):
        return given
    found: dict[str, Any] = {}
    for each in texts:
        name, equals, value = (part.strip() for part in each.partition("="))
        if not equals or not name or not value:
            raise ValueError(f"{what} is {each!r}; expected a mapping by name, or a text {expected}")
        if name in found:
            raise ValueError(f"{what} has {name} twice")
        found[name] = value
    return found


def _known(starts: Mapping[str, float], fixed: Any, bounds: Any, start: Any, prior: Any, constraint: Any) -> dict[str, Any]:
    fixed, start = _by_name(fixed, "fixed", "NAME=VALUE"), _by_name(start, "start", "NAME=VALUE")
    bounds, prior = _by_name(bounds, "bounds", "NAME=LOW:HIGH"), _by_name(prior, "prior", "NAME=VALUE+-DEVIATION")
    both = set(start) & set(fixed) if start and fixed else ()
    if both:
        raise ValueError(f"parameter {sorted(both)[0]} is fixed, so it takes no start")
    # What is not given costs nothing: a small fit takes less than a tenth of a millisecond.
    return {
        "fixed": _numbers(fixed, "fixed"),
        "bounds": _ranges(bounds) if bounds else {},
        "start": {**starts, **_numbers(start, "start")},
        "prior": {name: _prior(name, told) for name, told in mapping(prior, "prior").items()} if prior else {},
        "constraint": _chains(constraint) if constraint else [],
    }


def _prior(name: str, told: Any) -> tuple[float, float, bool]:
    try:
        value, deviation = re.split(r"\+-|\xb1", told) if isinstance(told, str) else told
        if isinstance(deviation, str) and deviation.endswith("%"):
            return float(value), float(deviation[:-1]) / 100, True
        return float(value), float(deviation), False
    except (TypeError, ValueError):
        raise ValueError(
            f"prior of {name} is {told!r}; expected (value, deviation), or a text value+-deviation or value+-share%"
        ) from None


def _chains(given: Any) -> list[list[str]]:
    chains = []
    for chain in [given] if isinstance(given, str) or not isinstance(given, Iterable) else given:
        names = [name.strip() for name in text(chain, "constraint").split("<")]
        if len(names) < 2 or not all(names) or any(name.startswith("=") for name in names):
            raise ValueError(f"constraint {chain!r}: expected names with < between them")
        chains.append(names)
    return chains


def _numbers(given: Mapping[str, float] | None, what: str) -> dict[str, float]:
    if not given:
        return {}
    return {name: value if type(value) is float else _value(value, f"{what} {name}") for name, value in mapping(given, what).items()}


def _value(given: Any, what: str) -> float:
    if not isinstance(given, str):
        return number(given, what)
    try:
        return float(given)
    except ValueError:
        raise ValueError(f"{what} is {given!r}; expected a number") from None


def _ranges(given: Any) -> dict[str, tuple[float | None, float | None]]:
    ranges = {}
    for name, limits in mapping(given, "bounds").items():
        try:
            if isinstance(limits, str):
                limits = [None if not end.strip() else _value(end, f"bounds {name}") for end in limits.split(":")]
            lower, upper = limits
        except (TypeError, ValueError):
            raise ValueError(f"bounds of {name} are {limits!r}; expected (lower, upper), None where there is none") from None
        ranges[name] = (
            None if lower is None else number(lower, f"bounds {name}"),
            None if upper is None else number(upper, f"bounds {name}"),
        )
    return ranges


def _range(value: Any, name: str) -> tuple[float, float]:
    return pair((value, value) if np.ndim(value) == 0 else value, name)


def _remark(parameter: Mapping[str, Any]) -> str:
    if parameter["fixed"]:
        return "fixed"
    if parameter["at_bound"]:
        return "at bound"
    return "" if parameter["identified"] else "not identified"
