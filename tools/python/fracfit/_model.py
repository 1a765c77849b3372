# SPDX-License-Identifier: BSD-3-Clause
"""Models given by a formula of s: responses, poles, margins, algebra, realisations."""

from __future__ import annotations

import math
import re
from typing import Any, Iterator, Mapping

import numpy as np

from . import _core
from ._arrays import Array, complex_array, count, mapping, number, pair, real_array, text
from ._data import FrequencyResponse, TimeSeries
from ._tables import Table
from ._text import escaped, html_table, short
from ._words import named, no_attribute

EXACT = {"name": "exact"}
_REALISATION = {"name": text, "band": pair, "poles": count, "sample_time": number, "memory": count}


def realisation_of(choice: Mapping[str, Any] | None) -> dict[str, Any]:
    """What stands for the powers of s, checked; exact if nothing is given."""
    if not choice:
        return EXACT
    unknown = set(mapping(choice, "realisation")) - set(_REALISATION)
    if unknown or choice.get("name") is None:
        wrong = f"has no {sorted(unknown)[0]!r}" if unknown else "needs a name"
        raise ValueError(f"realisation {wrong}; it takes {', '.join(_REALISATION)}, as in {{'name': 'oustaloup', 'band': (0.01, 100), 'poles': 9}}")
    return {key: _REALISATION[key](value, f"{key} of realisation") for key, value in choice.items() if value is not None}


class _Record:
    """Named values of a result, as attributes; prints and pickles."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.__dict__.update(values)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return _equal(self._values(), other._values())

    __hash__ = None  # type: ignore[assignment]

    def __getattr__(self, name: str) -> Any:
        raise no_attribute(self, name, self.__dict__)

    def __dir__(self) -> list[str]:
        return sorted(name for name in {*super().__dir__(), *self.__dict__} if not name.startswith("_") or name.startswith("__"))

    def _values(self) -> dict[str, Any]:
        # Names with an underscore are of what a result was made from, and of what was worked out later.
        return {name: value for name, value in self.__dict__.items() if not name.startswith("_")}

    def _rows(self) -> list[tuple[str, str]]:
        return [(name, _shown(value)) for name, value in self._values().items() if name != "summary" and not _is_empty(value)]

    def __repr__(self) -> str:
        return f"{type(self).__name__}:\n" + "\n".join(f"  {name} = {value}" for name, value in self._rows())

    def _repr_html_(self) -> str:
        return html_table(["", ""], self._rows(), type(self).__name__)


class Stability(_Record):
    """Stability and poles of a model.

    Attributes
    ----------
    stability : str
        stable, marginal, unstable, integrating, differentiating or undetermined.
    poles : ndarray of complex
        Roots of the denominator with ``|arg s| <= pi``, rad/s; of a pair the one above the real axis.
    multiplicity, cancelled : ndarray
        Of each pole.
    commensurate_order : float or None
    remark : str
        Why it is undetermined, else empty.
    """

    stability: str
    poles: Array
    multiplicity: Array
    cancelled: Array
    commensurate_order: float | None
    remark: str
    summary: str


class Margins(_Record):
    """Margins of a loop.

    Attributes
    ----------
    gain_margin, gain_reduction : float
        The factors above and below 1 nearest to it that put a closed-loop pole on the imaginary axis.
    phase_margin : float
        rad.
    delay_margin : float
        In seconds.
    phase_crossovers : ndarray
        Rows of frequency (rad/s) and factor where the loop is real and negative.
    gain_crossovers : ndarray
        Rows of frequency (rad/s) and phase margin (rad) where its modulus is 1.
    remark : str
    """

    gain_margin: float
    gain_reduction: float
    phase_margin: float
    delay_margin: float
    phase_crossovers: Array
    gain_crossovers: Array
    remark: str


class Realisation(_Record):
    """State space that stands for a model on a band; ``realisation.ss`` goes into `scipy.signal` and python-control.

    Attributes
    ----------
    A, B, C, D : ndarray
        Of the state space.
    delay : float
        Dead time that belongs in front, s.
    max_relative_error, omega_at_maximum : float
        Largest ``|H/G - 1|`` on the band, measured, and where (rad/s).
    usable : bool
        The tolerance is kept.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    delay: float
    method: str
    stable: bool
    max_relative_error: float
    omega_at_maximum: float
    usable: bool
    message: str
    summary: str

    @property
    def ss(self) -> tuple[Array, Array, Array, Array]:
        """(A, B, C, D)."""
        return self.A, self.B, self.C, self.D

    def control(self) -> Any:
        """The system as one of python-control; its dead time is not in it, see `delay`."""
        return _control().ss(*self.ss)

    def scipy(self) -> Any:
        """The system as one of `scipy.signal`; its dead time is not in it, see `delay`."""
        return _scipy_signal().StateSpace(*self.ss)


class DigitalPower(_Record):
    """The recursion in the samples that stands for a power of s.

    ``H(z) = ((1 - 1/z)/T)^differences (T/2 (z + 1)/(z - 1))^integrators (sum taps_k z^-k) gain prod(1 + feed/(z - 1 + rate))``

    Attributes
    ----------
    sample_time : float
        T, in seconds.
    discretisation : str
    taps, rates, feeds : ndarray
        Of the transversal part, and of each section of first order: ``y = x + feed v``, ``v += x - rate v``.
    gain : float
    differences, integrators : int
    max_relative_error, omega_at_maximum : float
        Of H against the power on the band.
    most_amplification : float
        Largest gain between the band and half the sampling frequency, over that of the power.
    usable : bool
    message, summary : str
    """

    sample_time: float
    discretisation: str
    taps: Array
    rates: Array
    feeds: Array
    gain: float
    differences: int
    integrators: int
    max_relative_error: float
    omega_at_maximum: float
    most_amplification: float
    usable: bool
    message: str
    summary: str

    def response(self, omega: Any) -> Array:
        """H at frequencies in rad/s, above 0 and below pi/T."""
        x = real_array(omega, "omega") * self.sample_time
        if not ((x > 0) & (x < math.pi)).all():
            raise ValueError(f"omega holds frequencies outside of 0 to {math.pi / self.sample_time:.6g} rad/s, half the sampling frequency")
        z = np.exp(1j * x)
        whole = ((1 - 1 / z) / self.sample_time) ** self.differences * (self.sample_time / 2 * (z + 1) / (z - 1)) ** self.integrators
        sections = np.prod(1 + self.feeds / (z[:, None] - 1 + self.rates), axis=1)
        return np.polynomial.polynomial.polyval(1 / z, self.taps) * whole * self.gain * sections  # type: ignore[no-any-return]


class Approximation(_Record):
    """Zeros, poles and gain that stand for a power of s on a band: ``gain s^integer_order prod(s - z)/prod(s - p)``.

    ``digital`` is the recursion in the samples where a sample time was given, else None.
    """

    zeros: Array
    poles: Array
    gain: float
    integer_order: int
    max_relative_error: float
    omega_at_maximum: float
    max_decibels: float
    max_degrees: float
    usable: bool
    message: str
    summary: str
    digital: DigitalPower | None

    @property
    def zpk(self) -> tuple[Array, Array, float]:
        """(zeros, poles, gain) with the whole power of s as roots at 0, as `scipy.signal` takes them."""
        at_zero = np.zeros(abs(self.integer_order))
        zeros, poles = self.zeros, self.poles
        if self.integer_order > 0:
            zeros = np.concatenate([zeros, at_zero])
        else:
            poles = np.concatenate([poles, at_zero])
        return zeros, poles, self.gain

    def control(self) -> Any:
        """The approximation as a system of python-control."""
        return _control().zpk(*self.zpk)

    def scipy(self) -> Any:
        """The approximation as a system of `scipy.signal`."""
        return _scipy_signal().ZerosPolesGain(*self.zpk)


class TimeResponse(_Record, Table):
    """Answer of a model over time; ``t, y = response`` takes it apart.

    Attributes
    ----------
    time, output : ndarray
    method : str
        How it was computed.
    error_estimate : float
        Absolute.
    meets_tolerance : bool
    """

    time: Array
    output: Array
    method: str
    error_estimate: float
    meets_tolerance: bool
    summary: str

    def _columns(self) -> dict[str, Any]:
        return {"time_s": self.time, "output": self.output}

    def __iter__(self) -> Iterator[Array]:
        return iter((self.time, self.output))

    def plot(self, *, ax: Any = None, **style: Any) -> Any:
        """Output over time, with matplotlib."""
        from .plots import plot_time

        return plot_time(self.time, self.output, ax=ax, **style)


class Model:
    """A model as a formula of s with named parameters.

    Parameters
    ----------
    formula : str
        Numbers, names, s, ``+ - * / ^``, parentheses, products by juxtaposition, exp, log, sqrt, sinh, cosh, tanh, coth,
        sech.  ``exp(-L s)`` is a dead time.
        Or a system of python-control or scipy.signal, or what the latter takes for one: (numerator, denominator),
        (zeros, poles, gain) or (A, B, C, D).
    **parameters : float
        Values of its parameters.  Those left out have to be fitted first; in a fit the others start there.

    Raises
    ------
    ValueError
        The formula does not parse (with a caret under the place), or has no such parameter.

    Examples
    --------
    >>> import numpy as np
    >>> from fracfit import Model
    >>> lag = Model("K/(T s^a + 1)", K=2, T=0.5, a=0.7)
    >>> lag
    Model('K/(T s^a + 1)', K=2, T=0.5, a=0.7)
    >>> omega, response = lag.frequency_response([1.0, 10.0])
    >>> response.round(4)
    array([1.4401-0.5229j, 0.4474-0.4674j])
    >>> lag(1j).round(4)
    (1.4401-0.5229j)
    >>> (lag * Model("1/s")).feedback().is_stable()
    True
    """

    def __init__(self, formula: str | Model | Any, **parameters: float) -> None:
        if isinstance(formula, Model):
            parameters = {**formula.parameters, **parameters}
            formula = formula.formula
        if not isinstance(formula, str):
            from ._doors import formula_of

            found = formula_of(formula)
            if found is None:
                raise ValueError(
                    f"formula is of the type {type(formula).__name__}; expected a text such as 'K/(T s^a + 1)', or a system of "
                    "python-control or scipy.signal"
                )
            formula = found
        self._structure = _core.Structure(formula)
        self._transfer_function: Any = None
        names = self._structure.parameter_names
        unknown = [name for name in parameters if name not in names]
        if unknown:
            if names == [formula]:
                raise ValueError(f"{formula} is taken as a formula of one parameter; those of presets stand in fracfit.presets()")
            known = ", ".join(names) if names else "none"
            raise ValueError(f"{formula} has no parameter {unknown[0]}; its parameters: {known}")
        self._parameters = {name: number(parameters[name], name) for name in names if name in parameters}
        for name, value in self._parameters.items():
            if not math.isfinite(value):
                raise ValueError(f"{name} is {value}; expected a finite number")

    @property
    def formula(self) -> str:
        """As it was given."""
        return self._structure.formula

    @property
    def parameters(self) -> dict[str, float]:
        """Values of those parameters that have one, in order of appearance."""
        return dict(self._parameters)

    @property
    def parameter_names(self) -> list[str]:
        """All parameters in order of appearance."""
        return list(self._structure.parameter_names)

    @property
    def grouped(self) -> str:
        """The formula as it was understood.

        Examples
        --------
        >>> from fracfit import Model
        >>> Model("K/(T s + 1) exp(-L s)").grouped
        '(K/(T s + 1)) exp(-L s)'
        """
        return self._structure.grouped

    @property
    def numerator(self) -> list[tuple[float, float]]:
        """Terms (coefficient, order), by falling order.

        Examples
        --------
        >>> from fracfit import Model
        >>> Model("(s^0.5 + 2)/(s + 1)").numerator
        [(1.0, 0.5), (2.0, 0.0)]
        """
        return self._tf.numerator

    @property
    def denominator(self) -> list[tuple[float, float]]:
        """Terms (coefficient, order), by falling order."""
        return self._tf.denominator

    @property
    def delay(self) -> float:
        """Dead time, s."""
        return self._tf.delay

    @property
    def is_fractional(self) -> bool:
        """Whether s stands under a power that is not whole, or whose order is a parameter."""
        return self._structure.is_fractional

    def with_parameters(self, **parameters: float) -> Model:
        """The same formula with these values.

        Examples
        --------
        >>> from fracfit import Model
        >>> Model("K/s^a", K=1, a=0.5).with_parameters(a=0.6)
        Model('K/s^a', K=1, a=0.6)
        """
        return Model(self.formula, **{**self._parameters, **parameters})

    def _values(self) -> list[float]:
        missing = [name for name in self._structure.parameter_names if name not in self._parameters]
        if missing:
            raise ValueError(f"{self.formula} has no value for {', '.join(missing)}; give them, or fit the model first")
        return [self._parameters[name] for name in self._structure.parameter_names]

    @property
    def _tf(self) -> Any:
        if self._transfer_function is None:
            self._transfer_function = self._structure.transfer_function(self._values())
        return self._transfer_function

    @property
    def _driven(self) -> Any:
        """What answers over time: a transfer function, or a closed loop with dead time, which is none."""
        try:
            return self._tf
        except _core.NoRatio:
            loop = self._structure.delayed_loop(self._values())
            if loop is None:
                raise
            return loop

    def __call__(self, s: Any) -> Any:
        """Value at complex s (rad/s), with the principal values of the powers; at ``1j*omega`` that of the formula.

        Returns
        -------
        complex or ndarray of the shape of s
        """
        shape = np.shape(s)
        points = complex_array(s, "s", ())
        if np.all((points.real == 0) & (points.imag > 0)):
            values = self._structure.response(self._values(), np.ascontiguousarray(points.imag), EXACT)
        else:
            values = self._tf.values_at(points)
        return values.reshape(shape) if shape else values[0]

    def frequency_response(self, omega: Any, *, realisation: Mapping[str, Any] | None = None) -> FrequencyResponse:
        """Response at angular frequencies.

        Parameters
        ----------
        omega : array_like
            rad/s, > 0, in any order; the answer is sorted.
        realisation : mapping, optional
            What stands for the powers of s: ``{"name": "oustaloup", "band": (1e-2, 1e3), "poles": 9}``, "ladder", or
            ``{"name": "grunwald-letnikov", "sample_time": 1e-3, "memory": 0}``.  Exact if not given.

        Returns
        -------
        FrequencyResponse
            ``omega, response = ...`` takes it apart.
        """
        omega = real_array(omega, "omega")
        values = self._structure.response(self._values(), omega, realisation_of(realisation))
        return FrequencyResponse(omega, values)

    def poles(self) -> Array:
        """Poles on the principal sheet, rad/s, both members of each pair.

        Raises
        ------
        ValueError
            Of a closed loop with dead time, which has infinitely many; ``is_stable()`` counts those that matter.

        Examples
        --------
        >>> from fracfit import Model
        >>> Model("1/(s^2 + 2 s + 5)").poles()
        array([-1.+2.j, -1.-2.j])
        """
        if not isinstance(self._driven, _core.TransferFunction):
            raise ValueError(
                f"{self.formula} is a closed loop with dead time, which has infinitely many poles; "
                "is_stable() tells its stability"
            )
        found = self._tf.stability()
        all_poles = []
        for pole, times in zip(found["poles"], found["multiplicity"]):
            pair = [pole] if pole.imag == 0 else [pole, pole.conjugate()]
            all_poles.extend(p for p in pair for _ in range(times))
        return np.array(all_poles, dtype=complex)

    def stability(self) -> Stability:
        """Poles, their multiplicity, and what they say."""
        return Stability(self._tf.stability())

    def is_stable(self) -> bool:
        """Whether a bounded input has a bounded output; of a closed loop with dead time too.

        Raises
        ------
        RuntimeError
            The poles could not be counted.

        Examples
        --------
        >>> from fracfit import Model
        >>> loop = Model("exp(-s)/s")
        >>> (1.57 * loop).feedback().is_stable(), (1.58 * loop).feedback().is_stable()    # up to pi/2
        (True, False)
        """
        driven = self._driven
        if isinstance(driven, _core.DelayedLoop):
            stability, remark = driven.closed_loop(), "its dead time makes more turns than can be followed"
        else:
            found = driven.stability()
            stability, remark = found["stability"], found["remark"]
        if stability == "undetermined":
            raise RuntimeError(f"the stability of {self.formula} is undetermined: {remark}")
        return stability == "stable"

    def margins(self) -> Margins:
        """Gain, phase and delay margin of the model as a loop.

        Examples
        --------
        >>> from fracfit import Model
        >>> margins = Model("2/(s (s + 1)^2)").margins()
        >>> round(margins.gain_margin, 6)
        1.0
        """
        return Margins(self._tf.margins())

    def closed_loop_stability(self) -> str:
        """Stability under unity feedback, dead time included: stable, marginal, unstable or undetermined."""
        return self._tf.closed_loop()[0]

    def h2_norm(self) -> float:
        """``sqrt(1/pi int |G|^2 d omega)``; infinite for a model that is not stable."""
        return self._tf.h2_norm()

    def hinf_norm(self) -> tuple[float, float]:
        """Largest ``|G|`` and where (rad/s)."""
        return self._tf.peak_gain()

    def step(self, time: Any, *, tolerance: float = 1e-9, method: str = "auto") -> TimeResponse:
        """Answer to a unit step at 0.

        Parameters
        ----------
        time : array_like
            Instants, s, rising.
        tolerance : float
            Over the largest output.
        method : {"auto", "reference", "exponential-sum", "grunwald-letnikov", "bdf2", "ladder"}

        Examples
        --------
        >>> from fracfit import Model
        >>> t, y = Model("1/(s + 1)").step([0, 1, 2])
        >>> y.round(6)
        array([0.      , 0.632121, 0.864665])
        """
        return self._respond("step", 0.0, time, tolerance, method)

    def impulse(self, time: Any, *, tolerance: float = 1e-9, method: str = "auto") -> TimeResponse:
        """Answer to a unit impulse at 0; see `step`."""
        return self._respond("impulse", 0.0, time, tolerance, method)

    def ramp(self, time: Any, *, tolerance: float = 1e-9, method: str = "auto") -> TimeResponse:
        """Answer to the input t; see `step`."""
        return self._respond("ramp", 0.0, time, tolerance, method)

    def sine(self, time: Any, omega: float, *, tolerance: float = 1e-9, method: str = "auto") -> TimeResponse:
        """Answer to ``sin(omega t)`` from rest, omega in rad/s; see `step`."""
        return self._respond("sine", number(omega, "omega"), time, tolerance, method)

    def _respond(self, kind: str, omega: float, time: Any, tolerance: float, method: str) -> TimeResponse:
        time = real_array(time, "time")
        found = _core.respond_named(self._driven, kind, omega, time, number(tolerance, "tolerance"), text(method, "method"))
        return _time_response(time, found)

    def respond(
        self,
        time: Any,
        input: Any = None,
        *,
        hold: str = "zero-order",
        at: Any = None,
        tolerance: float = 1e-9,
        method: str = "auto",
    ) -> TimeResponse:
        """Answer to any input given by samples, from rest.

        Parameters
        ----------
        time : array_like or TimeSeries
            Instants of the samples, s, rising; or a record, whose input is taken.
        input : array_like
            Samples.
        hold : {"zero-order", "first-order", "band-limited"}
            How the input runs between them; band-limited: repeating itself for ever, answered by the steady state.
        at : array_like, optional
            Instants of the answer; those of the samples if not given.

        Examples
        --------
        >>> from fracfit import Model
        >>> t, y = Model("1/s^0.5").respond([0, 1, 2, 3], [1, 1, 0, 0])
        >>> y.round(4)  # 2/sqrt(pi) (sqrt(t) - sqrt(t - 2))
        array([0.    , 1.1284, 1.5958, 0.826 ])
        """
        if isinstance(time, TimeSeries):
            time, input, hold = time.time, time.input, time.hold
        if hold not in ("zero-order", "first-order", "band-limited"):
            raise ValueError(f"hold is {hold!r}; expected zero-order, first-order or band-limited")
        time = real_array(time, "time")
        input = real_array(input, "input", time.shape)
        instants = time if at is None else real_array(at, "at")
        found = _core.respond_sampled(
            self._driven, time, input, hold, instants, number(tolerance, "tolerance"), text(method, "method")
        )
        return _time_response(instants, found)

    def realise(self, band: tuple[float, float], tolerance: float = 1e-3, *, method: str = "joint") -> Realisation:
        """State space with the fewest states that keeps a tolerance on a band.

        Parameters
        ----------
        band : (float, float)
            rad/s.
        tolerance : float
            Largest ``|H/G - 1|``.
        method : {"joint", "term-by-term"}
            One set of poles for the whole model, or one for each power of s.

        Examples
        --------
        >>> from fracfit import Model
        >>> small = Model("1/(s^0.5 + 1)").realise((0.01, 100), 1e-2)
        >>> small.max_relative_error < 1e-2
        True
        """
        found = _core.realise(self._tf, *pair(band, "band"), number(tolerance, "tolerance"), text(method, "method"))
        return Realisation(found)

    def simplified(self) -> Model:
        """The same function of s with fewer terms where it has them."""
        return _model_of(self._tf.simplified())

    def _polynomials(self) -> tuple[list[float], list[float]]:
        """Numerator and denominator in falling whole powers of s."""
        if self.delay or any(order != round(order) or order < 0 for _, order in (*self.numerator, *self.denominator)):
            what = f"the dead time {self.delay:g} s" if self.delay else "powers of s that are not whole"
            raise ValueError(f"{self.formula} has {what}; a system of that package has none: realise(band, tolerance) makes one on a band")

        def dense(terms: list[tuple[float, float]]) -> list[float]:
            coefficients = [0.0] * (round(terms[0][1]) + 1)
            for coefficient, order in terms:
                coefficients[len(coefficients) - 1 - round(order)] = coefficient
            return coefficients

        return dense(self.numerator), dense(self.denominator)

    def control(self) -> Any:
        """The model as a system of python-control, where its powers of s are whole; else see `realise`.

        Raises
        ------
        ValueError
            A power of s is not whole, or there is a dead time.
        """
        numerator, denominator = self._polynomials()
        return _control().tf(numerator, denominator)

    def scipy(self) -> Any:
        """The same as a system of `scipy.signal`.

        Examples
        --------
        >>> from fracfit import Model
        >>> Model(Model("2/(s^2 + 3 s + 4)").scipy())
        Model('(2)/(s^2 + 3 s + 4)')
        """
        numerator, denominator = self._polynomials()
        return _scipy_signal().TransferFunction(numerator, denominator)

    def feedback(self, other: Model | float = 1, sign: int = -1) -> Model:
        """Closed loop ``self/(1 - sign self other)``.

        With dead time in the loop the result is no ratio of sums of powers: it has a frequency response and answers
        over time, with a stated error, and ``is_stable()`` tells its stability; its poles are infinitely many.

        Examples
        --------
        >>> from fracfit import Model
        >>> Model("1/s^0.5").feedback()
        Model('1/(s^0.5 + 1)')
        >>> t, y = Model("0.5 exp(-1 s)/s").feedback().step([1, 2, 3])
        >>> y.round(6)  # (t - 1)/2 - (t - 2)^2/8 from 1 and 2 s on
        array([0.   , 0.5  , 0.875])
        """
        if sign not in (-1, 1):
            raise ValueError(f"sign is {sign!r}; expected -1 for negative or 1 for positive feedback")
        try:
            back = _transfer_function(other)
            if sign == 1:
                back = _core.TransferFunction.parse("-1").multiply(back)
            return _model_of(self._tf.feedback(back))
        except _core.NoRatio:
            return _written("({0})/(1 " + ("-" if sign == 1 else "+") + " ({0}) ({1}))", self, other)

    def _combined(self, operation: str, other: Any, *, swapped: bool = False) -> Any:
        if not isinstance(other, (Model, int, float, np.number)):
            return NotImplemented
        if operation == "add" and not isinstance(other, Model) and other == 0:
            return self  # the start of sum()
        a, b = (other, self) if swapped else (self, other)
        try:
            return _model_of(getattr(_transfer_function(a), operation)(_transfer_function(b)))
        except _core.NoRatio:
            return _written(_COMBINED[operation], a, b)

    def __add__(self, other: Any) -> Any:
        return self._combined("add", other)

    def __radd__(self, other: Any) -> Any:
        return self._combined("add", other, swapped=True)

    def __sub__(self, other: Any) -> Any:
        return self._combined("subtract", other)

    def __rsub__(self, other: Any) -> Any:
        return self._combined("subtract", other, swapped=True)

    def __mul__(self, other: Any) -> Any:
        return self._combined("multiply", other)

    def __rmul__(self, other: Any) -> Any:
        return self._combined("multiply", other, swapped=True)

    def __truediv__(self, other: Any) -> Any:
        return self._combined("divide", other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._combined("divide", other, swapped=True)

    def __neg__(self) -> Any:
        return self._combined("multiply", -1)

    def fit(self, data: Any, **options: Any) -> Any:
        """Fits the parameters to a frequency response or a record over time; see `fracfit.fit`.

        Those parameters that have values start there.
        """
        from . import fit

        return fit(data, self, **options)

    # Numbers of numpy leave products with models to the models.
    __array_ufunc__ = None

    def __getattr__(self, name: str) -> Any:
        raise no_attribute(self, name)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        return self.formula == other.formula and self._parameters == other._parameters

    def __hash__(self) -> int:
        return hash((self.formula, tuple(self._parameters.items())))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.formula, self._parameters)

    def __repr__(self) -> str:
        values = "".join(f", {name}={value:.6g}" for name, value in self._parameters.items())
        return f"Model({self.formula!r}{values})"

    def _repr_html_(self) -> str:
        rows = [(name, self._parameters.get(name, math.nan)) for name in self.parameter_names]
        return f"<code>{escaped(self.formula)}</code>" + (html_table(["parameter", "value"], rows) if rows else "")


@named
def approximate(
    order: float,
    band: tuple[float, float],
    *,
    tolerance: float | None = None,
    poles: int | None = None,
    method: str = "ladder",
    sample_time: float | None = None,
    discretisation: str | None = None,
    amplification: float | None = None,
    taps: int | None = None,
) -> Approximation:
    """Rational approximation of ``s^order`` on a band, and with a sample time the recursion in the samples.

    Parameters
    ----------
    order : float
        The power of s that is stood for.
    band : (float, float)
        rad/s.
    tolerance : float, optional
        Largest relative error to keep with the fewest poles; or
    poles : int, optional
        Their number.
    method : {"ladder", "oustaloup", "oustaloup-widened", "refined-oustaloup", "matsuda", "carlson", "cfe", "charef"}
        Where zeros and poles come from.
    sample_time : float, optional
        In seconds: gives ``digital``, the recursion in the samples.
    discretisation : {"direct", "tustin", "tustin-prewarped", "al-alaoui", "grunwald-letnikov"}
        How it is made; "direct" if not given.
    amplification : float, optional
        With "direct" the most gain between the band and half the sampling frequency, over that of the power; 5 if not given.
    taps : int, optional
        With "grunwald-letnikov" its memory in samples; 1000 if not given.

    Examples
    --------
    >>> import fracfit
    >>> half = fracfit.approximate(0.5, (0.01, 100), tolerance=1e-3)
    >>> half.max_relative_error < 1e-3
    True
    >>> recursion = fracfit.approximate(0.5, (0.1, 100), tolerance=1e-3, sample_time=1e-3).digital
    >>> bool(abs(recursion.response([10.0])[0] / (10j) ** 0.5 - 1) < 1e-3)
    True
    """
    for name, value, rule in (("amplification", amplification, "direct"), ("taps", taps, "grunwald-letnikov")):
        if value is not None and (discretisation or "direct") != rule:
            raise ValueError(f"{name} has no meaning but with discretisation {rule!r}")
    for name, value in (("discretisation", discretisation), ("amplification", amplification), ("taps", taps)):
        if value is not None and sample_time is None:
            raise ValueError(f"{name} has no meaning without sample_time, which asks for the recursion in the samples")
    tolerance = None if tolerance is None else number(tolerance, "tolerance")
    poles = None if poles is None else count(poles, "poles")
    wanted = (number(order, "order"), *pair(band, "band"), tolerance, poles, text(method, "method"))
    found = _core.approximate(*wanted)
    found["digital"] = None
    if sample_time is not None:
        rule = text("direct" if discretisation is None else discretisation, "discretisation")
        memory, gain = 1000 if taps is None else count(taps, "taps"), 5.0 if amplification is None else number(amplification, "amplification")
        found["digital"] = DigitalPower(_core.digital_power(*wanted, number(sample_time, "sample_time"), rule, memory, gain))
        found["usable"] = found["usable"] and found["digital"].usable
    return Approximation(found)


def _control() -> Any:
    try:
        import control
    except ImportError:
        raise ImportError("control() needs the package control (python-control); scipy() needs scipy") from None
    return control


def _scipy_signal() -> Any:
    try:
        from scipy import signal
    except ImportError:
        raise ImportError("scipy() needs the package scipy") from None
    return signal


def _restored(formula: str, parameters: dict[str, float]) -> Model:
    return Model(formula, **parameters)


def _model_of(transfer_function: Any) -> Model:
    return Model(transfer_function.formula)


def _transfer_function(value: Any) -> Any:
    if isinstance(value, Model):
        return value._tf
    return _core.TransferFunction.parse(f"{_factor(value):.17g}")


def _factor(value: Any) -> float:
    factor = number(value, "factor")
    if not math.isfinite(factor):
        raise ValueError(f"the factor is {factor}; expected a finite number")
    return factor


_COMBINED = {"add": "({}) + ({})", "subtract": "({}) - ({})", "multiply": "({}) ({})", "divide": "({})/({})"}
# Numbers go first, so that the e of 1e-3 is no name.
_WORDS = re.compile(r"[0-9.]+(?:[eE][+-]?[0-9]+)?|(\w+)")


def _written(pattern: str, *parts: Model | float) -> Model:
    """Models that are no ratio of sums of powers, combined as one formula with numbers for parameters."""

    def digits(value: float) -> str:
        return repr(value).removesuffix(".0")

    def formula_of(part: Model | float) -> str:
        if not isinstance(part, Model):
            return digits(_factor(part))
        values = dict(zip(part.parameter_names, part._values()))
        return _WORDS.sub(lambda word: f"({digits(values[word[1]])})" if word[1] in values else word[0], part.grouped)

    return Model(pattern.format(*map(formula_of, parts)))


def _time_response(time: Array, found: dict[str, Any]) -> TimeResponse:
    return TimeResponse({"time": time, **found})


def _equal(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        # The time that it took is no part of a result.
        return a.keys() == b.keys() and all(_equal(a[key], b[key]) for key in a if key != "seconds")
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(_equal, a, b))
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind in "fc")
    return a == b or (isinstance(a, float) and isinstance(b, float) and math.isnan(a) and math.isnan(b))


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size > 6:
        return f"array of {value.dtype} of the shape {value.shape}"
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        if len(value) > 6:
            return f"{len(value)} entries"
        inside = ", ".join(map(_shown, value))
        return f"[{inside}]" if isinstance(value, list) else f"({inside})"
    return short(value)


def _is_empty(value: Any) -> bool:
    return isinstance(value, str) and not value
