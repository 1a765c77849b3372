# SPDX-License-Identifier: BSD-3-Clause
"""Measured data: frequency responses, records over time, and files of them."""

from __future__ import annotations

import os
import warnings
from typing import Any, Iterator, Mapping, Sequence

import numpy as np

from . import _core
from ._arrays import NO_NUMBERS, Array, complex_array, flag, in_words, mapping, number, path_of, real_array, text
from ._tables import Table, column_unit
from ._text import html_table
from ._words import named, no_attribute


class _Samples(Table):
    """Arrays of one length.

    No sequence: it unpacks into its arrays, ``data[...]`` is a choice of its points, ``data.size`` their number.
    """

    @property
    def size(self) -> int:
        """Number of points."""
        raise NotImplementedError

    def __getattr__(self, name: str) -> Any:
        raise no_attribute(self, name)

    def __bool__(self) -> bool:
        return True

    def __len__(self) -> int:
        warnings.warn(f"a {type(self).__name__} is no sequence: write its size in place of its len()", DeprecationWarning, stacklevel=2)
        return self.size


class FrequencyResponse(_Samples):
    """Samples of a frequency response.

    It unpacks into its arrays, ``omega, response = data``; ``data[10:20]``, a mask or indices choose points of it.

    Parameters
    ----------
    omega : array_like
        Angular frequencies, rad/s, positive.  They are sorted; equal ones are repeated measurements.
    response : array_like of complex
        Values, output per input.
    sigma : array_like, optional
        Standard deviation of the real and of the imaginary part of each value, > 0.
    unit : str, optional
        Unit of the values, for labels.
    frequency_unit : {"rad/s", "Hz"}
        In which sentences and pictures name a frequency; numbers are rad/s all the same.
    metadata : mapping, optional
        Further facts, such as the header of a file.  ``computed_by`` names what computed values without noise.

    Raises
    ------
    ValueError
        Lengths differ, a frequency is not positive, or a number is not finite; the sentence names the first one.

    See Also
    --------
    read : from a file.
    FrequencyResponse.from_hz : from frequencies in Hz.

    Examples
    --------
    >>> import fracfit
    >>> data = fracfit.FrequencyResponse([1, 2, 4], [1 - 1j, 0.5 - 0.8j, 0.2 - 0.5j])
    >>> data
    FrequencyResponse(3 points, 1 to 4 rad/s)
    >>> omega, response = data
    >>> response[0]
    (1-1j)
    """

    @named
    def __init__(
        self,
        omega: Any,
        response: Any,
        sigma: Any = None,
        *,
        unit: str = "",
        frequency_unit: str = "rad/s",
        metadata: Mapping[str, str] | None = None,
    ) -> None:
        if frequency_unit not in ("rad/s", "Hz"):
            raise ValueError(f"frequency_unit is {frequency_unit!r}; expected rad/s or Hz")
        omega = real_array(omega, "omega")
        response = complex_array(response, "response")
        spread = NO_NUMBERS if sigma is None else real_array(sigma, "sigma")
        if omega.size == response.size and spread.size in (0, omega.size) and np.any(omega[1:] < omega[:-1]):
            order = np.argsort(omega, kind="stable")
            omega, response = omega[order], response[order]
            if spread.size:
                spread = spread[order]
        _core.check_frequency_response(omega, response, spread)
        self._omega = _frozen(omega)
        self._response = _frozen(response)
        self._sigma = _frozen(spread) if spread.size else None
        self.unit = text(unit, "unit")
        self.frequency_unit = frequency_unit
        self.metadata = dict(mapping(metadata or {}, "metadata"))

    @classmethod
    def from_hz(cls, f: Any, response: Any, sigma: Any = None, **more: Any) -> FrequencyResponse:
        """The same from frequencies in Hz, in which sentences and pictures then name them.

        Examples
        --------
        >>> import fracfit
        >>> data = fracfit.FrequencyResponse.from_hz([100, 10], [1, 2])
        >>> data
        FrequencyResponse(2 points, 10 to 100 Hz)
        >>> data.f
        array([ 10., 100.])
        """
        return cls(2 * np.pi * real_array(f, "f"), response, sigma, **{"frequency_unit": "Hz", **more})

    @classmethod
    def of(cls, data: Any, values: Any = None) -> FrequencyResponse:
        """From whatever `fit` takes for one: two arrays, frequencies in Hz first; a table with named columns; xarray; python-control.

        Examples
        --------
        >>> import fracfit
        >>> fracfit.FrequencyResponse.of({"f_Hz": [1.0, 10.0], "re_ohm": [2.0, 1.0], "im_ohm": [-1.0, -0.5]})
        FrequencyResponse(2 points, 1 to 10 Hz, ohm)
        """
        from ._doors import response_of

        return response_of(data, values)

    @property
    def omega(self) -> Array:
        """Angular frequencies, rad/s, rising."""
        return self._omega

    @property
    def f(self) -> Array:
        """Frequencies, Hz."""
        return self._omega / (2 * np.pi)

    @property
    def response(self) -> Array:
        """Complex values."""
        return self._response

    @property
    def sigma(self) -> Array | None:
        """Standard deviations, or None."""
        return self._sigma

    @property
    def magnitude(self) -> Array:
        """Moduli of the values."""
        return np.abs(self._response)

    @property
    def phase(self) -> Array:
        """Phases, rad, without jumps by 2 pi."""
        return np.unwrap(np.angle(self._response))

    @property
    def is_computed(self) -> bool:
        """The metadata name a computation that made the values: they have no noise."""
        return "computed_by" in self.metadata or self.metadata.get("command", "").startswith(("fracfit simulate ", "fracfit map ", "fracfit evaluate "))

    @property
    def sigma_is_measured(self) -> bool:
        """The metadata say that sigma was measured, as `response` does: fits are weighed with it unless told otherwise."""
        return self._sigma is not None and self.metadata.get("sigma") == "measured"

    def where(self, *conditions: Any) -> FrequencyResponse:
        """The points that satisfy all conditions.

        Parameters
        ----------
        *conditions : str or array_like of bool
            A comparison of re, im, magnitude, omega (rad/s) or f (Hz) with a number, as in ``"im<0"``; or a mask.

        Examples
        --------
        >>> import fracfit
        >>> data = fracfit.FrequencyResponse([1, 2, 4], [1 - 1j, 0.5 - 0.8j, 0.2 + 0.5j])
        >>> data.where("omega >= 2", "im<0").size
        1
        """
        kept = np.ones(self.size, dtype=bool)
        for condition in conditions:
            if isinstance(condition, str):
                from . import _files

                try:
                    kept &= _files.points_where(condition, self._omega, self._response)
                except ValueError as reason:
                    raise ValueError(str(reason).replace("--where", "condition")) from None
                continue
            mask = np.asarray(condition)
            if mask.dtype != bool or mask.shape != kept.shape:
                raise ValueError(f"a condition has the shape {mask.shape} and the dtype {mask.dtype}; expected {kept.shape} and bool")
            kept &= mask
        return self[kept]

    def minus_inverse(self) -> FrequencyResponse:
        """-1/N of a describing function N, with sigma carried over; of -1/N it is N.

        Points at which N is 0 have none and are left out, which the metadata tell.

        Examples
        --------
        >>> import fracfit
        >>> stiffness = fracfit.FrequencyResponse([1, 2, 4], [-0.5, 0, 0.25j], unit="m/N").minus_inverse()
        >>> stiffness.omega, abs(stiffness.response), stiffness.unit
        (array([1., 4.]), array([2., 4.]), 'N/m')
        """
        above, slash, below = self.unit.partition("/")
        return self._inverse(-1, f"{below}/{above}" if slash else self.unit and f"1/{self.unit}", "N")

    def inverse(self) -> FrequencyResponse:
        """1 over the values, with sigma carried over: the admittance of an impedance, and the impedance of an admittance.

        Points at which the values are 0 have none and are left out, which the metadata tell.

        Examples
        --------
        >>> import fracfit
        >>> admittance = fracfit.FrequencyResponse([1, 2], [2, 4j], unit="kohm").inverse()
        >>> abs(admittance.response), admittance.unit
        (array([0.5 , 0.25]), 'mS')
        """
        from . import _files

        return self._inverse(1, _files.inverse_unit(self.unit), "the response")

    def _as_immittance(self, wanted: str) -> FrequencyResponse:
        """The impedance or the admittance, whichever of both the values are; without a unit they are taken for the other one."""
        from . import _files

        held = _files.immittance_of_unit(self.unit)
        if held == wanted:
            return self
        if not held and self.unit not in ("", "1"):
            raise ValueError(f"the values are in {self.unit}, neither an impedance nor an admittance, so that there is no {wanted}")
        if not held:
            other = "impedance" if wanted == "admittance" else "admittance"
            warnings.warn(f"the data have no unit; they are taken for the {other}, and 1 over them for the {wanted}", stacklevel=5)
        return self.inverse()

    def _inverse(self, sign: int, unit: str, name: str) -> FrequencyResponse:
        sigma = np.zeros(self.size) if self._sigma is None else self._sigma
        response, spread = _core.minus_inverse(self._response, sigma)
        kept = np.isfinite(response)
        metadata = dict(self.metadata)
        if not kept.all():
            lost = ", ".join(f"{omega:g}" for omega in self._omega[~kept])
            metadata["notes"] = " ".join(filter(None, [metadata.get("notes", ""), f"Left out at {lost} rad/s, where {name} is 0."]))
        return FrequencyResponse(
            self._omega[kept],
            response[kept] if sign < 0 else -response[kept],
            None if self._sigma is None else spread[kept],
            unit=unit,
            frequency_unit=self.frequency_unit,
            metadata=metadata,
        )

    def plot(self, *, kind: str = "bode", ax: Any = None, **options: Any) -> Any:
        """A picture with matplotlib, ``kind`` "bode" or "nyquist"; see `plot_bode` and `plot_nyquist`."""
        from . import plots

        draw = {"bode": plots.plot_bode, "nyquist": plots.plot_nyquist}.get(kind)
        if draw is None:
            raise ValueError(f"kind is {kind!r}; expected bode or nyquist")
        return draw(self, ax=ax, **options)

    def __iter__(self) -> Iterator[Array]:
        return iter((self._omega, self._response))

    def __getitem__(self, points: Any) -> FrequencyResponse:
        """Some of the points: a slice, an index or several, or a mask."""
        try:
            kept = np.atleast_1d(np.arange(self.size)[points])
        except IndexError:
            raise IndexError(f"{points!r} is no choice of {self.size} points; expected a slice, an index, several, or a mask") from None
        if not kept.size:
            raise ValueError("no point is left")
        sigma = None if self._sigma is None else self._sigma[kept]
        return FrequencyResponse(
            self._omega[kept],
            self._response[kept],
            sigma,
            unit=self.unit,
            frequency_unit=self.frequency_unit,
            metadata=self.metadata,
        )

    @property
    def size(self) -> int:
        """Number of points."""
        return self._omega.size

    def _columns(self) -> dict[str, Any]:
        unit = column_unit(self.unit)
        columns = {"omega_rad_s": self._omega, f"re{unit}": self._response.real, f"im{unit}": self._response.imag}
        return columns if self._sigma is None else {**columns, f"sigma{unit}": self._sigma}

    def _head(self) -> Mapping[str, str]:
        return self.metadata

    def to_xarray(self) -> Any:
        """An `xarray.DataArray` of the complex values over omega, with units as its attributes."""
        try:
            import xarray
        except ImportError:
            raise ImportError("to_xarray() needs xarray; to_dataframe() needs pandas, to_csv() neither") from None
        axis = xarray.DataArray(self._omega, dims="omega", attrs={"units": "rad/s"})
        coords = {"omega": axis} if self._sigma is None else {"omega": axis, "sigma": ("omega", self._sigma)}
        return xarray.DataArray(self._response, dims="omega", coords=coords, name="response", attrs={"units": self.unit})

    def control(self) -> Any:
        """The response as one of python-control, `control.FRD`."""
        try:
            import control
        except ImportError:
            raise ImportError("control() needs the package control (python-control)") from None
        return control.FRD(self._response, self._omega)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, FrequencyResponse):
            return NotImplemented
        return (
            np.array_equal(self._omega, other._omega)
            and np.array_equal(self._response, other._response)
            and _same(self._sigma, other._sigma)
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        sigma = "" if self._sigma is None else ", with sigma"
        unit = f", {self.unit}" if self.unit else ""
        count = f"{self.size} point" + ("s" if self.size > 1 else "")
        first, last = self._shown(self._omega[[0, -1]])
        return f"FrequencyResponse({count}, {first:g} to {last:g} {self.frequency_unit}{unit}{sigma})"

    def _repr_html_(self) -> str:
        unit = f", {self.unit}" if self.unit else ""
        shown = self._shown(self._omega)
        step = max(1, -(-self.size // 12))
        rows = [(w, z.real, z.imag) for w, z in zip(shown[::step].tolist(), self._response[::step].tolist())]
        axis = "f, Hz" if self.frequency_unit == "Hz" else "omega, rad/s"
        return html_table([axis, "Re" + unit, "Im" + unit], rows, repr(self) + (f", every {step}th" if step > 1 else ""))

    def _shown(self, omega: Array) -> Array:
        """Frequencies in the unit of sentences and pictures."""
        return omega / (2 * np.pi) if self.frequency_unit == "Hz" else omega

    def _arrays(self) -> dict[str, Any]:
        return {
            "omega": self._omega,
            "response": self._response,
            "sigma": NO_NUMBERS if self._sigma is None else self._sigma,
            "frequency_unit": self.frequency_unit,
        }


class TimeSeries(_Samples):
    """Samples of the input and the output of a system over time.

    Parameters
    ----------
    time : array_like
        s, strictly rising, steps of any length.
    input, output : array_like
        What drove the system and what it answered.
    sigma : array_like, optional
        Standard deviation of each output, > 0.
    hold : {"zero-order", "first-order", "band-limited"}
        How the input runs between samples: constant, straight to the next, or as the band-limited signal that repeats
        itself for ever, with the output in its periodic steady state (even steps).
    input_at_rest : float
        Input before the first sample, long enough for the output to have settled.

    Examples
    --------
    >>> import fracfit
    >>> fracfit.TimeSeries([0, 1, 2], [1, 1, 1], [0, 0.6, 0.9])
    TimeSeries(3 samples, 0 to 2 s)
    """

    @named
    def __init__(
        self,
        time: Any,
        input: Any,
        output: Any,
        sigma: Any = None,
        *,
        hold: str = "zero-order",
        input_at_rest: float = 0.0,
        kept: Any = None,
        metadata: Mapping[str, str] | None = None,
    ) -> None:
        if hold not in ("zero-order", "first-order", "band-limited"):
            raise ValueError(f"hold is {hold!r}; expected zero-order, first-order or band-limited")
        time = real_array(time, "time")
        input = real_array(input, "input")
        output = real_array(output, "output")
        spread = NO_NUMBERS if sigma is None else real_array(sigma, "sigma")
        _core.check_time_response(time, input, output, spread)
        self._time = _frozen(time)
        self._input = _frozen(input)
        self._output = _frozen(output)
        self._sigma = _frozen(spread) if spread.size else None
        self.hold = hold
        self.input_at_rest = number(input_at_rest, "input_at_rest")
        self._kept = None if kept is None else _indices(kept, time.size)
        self.metadata = dict(mapping(metadata or {}, "metadata"))

    @property
    def time(self) -> Array:
        """s."""
        return self._time

    @property
    def input(self) -> Array:
        """Samples of the input."""
        return self._input

    @property
    def output(self) -> Array:
        """Samples of the output."""
        return self._output

    @property
    def sigma(self) -> Array | None:
        """Standard deviations of the output, or None."""
        return self._sigma

    def __iter__(self) -> Iterator[Array]:
        return iter((self._time, self._output))

    @property
    def size(self) -> int:
        """Number of samples."""
        return self._time.size

    def _columns(self) -> dict[str, Any]:
        columns = {"time_s": self._time, "input": self._input, "output": self._output}
        return columns if self._sigma is None else {**columns, "sigma": self._sigma}

    def _head(self) -> Mapping[str, str]:
        return self.metadata

    def plot(self, *, ax: Any = None, **style: Any) -> Any:
        """Output over time, with matplotlib."""
        from .plots import plot_time

        return plot_time(self._time, self._output, ax=ax, **style)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TimeSeries):
            return NotImplemented
        return (
            np.array_equal(self._time, other._time)
            and np.array_equal(self._input, other._input)
            and np.array_equal(self._output, other._output)
            and _same(self._sigma, other._sigma)
            and _same(self._kept, other._kept)
            and (self.hold, self.input_at_rest) == (other.hold, other.input_at_rest)
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        sigma = "" if self._sigma is None else ", with sigma"
        return f"TimeSeries({self.size} samples, {self._time[0]:g} to {self._time[-1]:g} s{sigma})"

    def _arrays(self) -> dict[str, Any]:
        return {
            "time": self._time,
            "input": self._input,
            "output": self._output,
            "sigma": NO_NUMBERS if self._sigma is None else self._sigma,
            "hold": self.hold,
            "input_at_rest": self.input_at_rest,
            "kept": self._kept,
        }


def _indices(given: Any, size: int) -> Array:
    numbers = real_array(given, "kept")
    if not np.all((numbers == np.floor(numbers)) & (numbers >= 0) & (numbers < size)):
        raise ValueError(f"kept has entries that are no index of the {size} samples")
    return numbers.astype(np.int64)


@named
def read(
    path: str | os.PathLike[str],
    *,
    columns: str = "",
    frequency_unit: str = "",
    select: str | int = "",
    where: str | Sequence[str] = (),
    weight_column: str | None = None,
    repeats: bool = False,
    quantity: str | None = None,
    hold: str = "zero-order",
    input_at_rest: float = 0.0,
) -> FrequencyResponse | TimeSeries:
    """Reads a measured frequency response, or samples of input and output over time.

    Tables with named columns and the files of common instruments (Gamry, BioLogic, ZView, VersaStudio, Touchstone,
    universal files) are recognised by their content, as on the command line.

    Parameters
    ----------
    path : path
        File to read.
    columns : str
        Which column is what where the names do not tell, by number or name, e.g. ``"f=1,re=2,-im=3"``.
    frequency_unit : str
        Unit of a frequency whose name has none, e.g. ``"Hz"``.
    select : str or int
        One of several sweeps in the file, by its name or its number from 1.
    where : str or sequence of str
        Points to keep, e.g. ``"omega<100"``; columns of the file may be compared too.
    weight_column : str, optional
        Column with standard deviations, or with weights of the squared residuals.
    repeats : bool
        Rows that repeat frequencies are repeated measurements, not further sweeps.
    quantity : {"n", "minus-inverse"}, optional
        Describing functions as N or as -1/N, whichever of both the file holds; as the file has it unless given.
    hold, input_at_rest
        Of samples over time, see `TimeSeries`.

    Returns
    -------
    FrequencyResponse or TimeSeries
        With what was assumed of the file as ``notes`` in its metadata.

    Raises
    ------
    RuntimeError
        The file cannot be read or is damaged; the sentence names file, line and column.
    ValueError
        An argument does not go with the file.
    """
    from . import _files

    given = {
        "columns": columns,
        "frequency_unit": frequency_unit,
        "select": str(select),
        "weight_column": weight_column,
        "repeats": flag(repeats, "repeats"),
        "quantity": quantity,
    }
    conditions = [where] if isinstance(where, str) else list(where)
    try:
        found = _files.read(path_of(path, "path"), given, conditions)
    except (ValueError, RuntimeError) as reason:
        raise type(reason)(in_words(reason)) from None
    is_response = "omega" in found
    idle = {"hold": hold != "zero-order", "input_at_rest": input_at_rest != 0} if is_response else given
    for name, is_given in idle.items():
        if is_given:
            raise ValueError(f"{name} has no meaning with {'a frequency response' if is_response else 'samples over time'}")
    metadata = dict(found["metadata"])
    if found["notes"]:
        metadata["notes"] = " ".join(found["notes"])
    sigma = found["sigma"] if found["sigma"].size else None
    if is_response:
        return FrequencyResponse(
            found["omega"],
            found["response"],
            sigma,
            unit=found["unit"],
            frequency_unit=found["frequency_unit"],
            metadata=metadata,
        )
    kept = found["kept"]
    return TimeSeries(
        found["time"],
        found["input"],
        found["output"],
        sigma,
        hold=hold,
        input_at_rest=input_at_rest,
        kept=None if kept.size == found["time"].size else kept,
        metadata=metadata,
    )


@named
def sweep_names(path: str | os.PathLike[str], key_column: str = "") -> list[str]:
    """Names of the curves in a file that holds several, as `read` takes them for ``select``; empty where it holds one.

    Parameters
    ----------
    path : path
        File to read.
    key_column : str
        Column whose values tell the curves apart.
    """
    from . import _files

    return _files.sweep_names(path_of(path, "path"), key_column)


def _frozen(array: Array) -> Array:
    # A caller's own array is not to change what was checked, nor to be made read-only.
    array = np.array(array)
    array.flags.writeable = False
    return array


def _same(a: Array | None, b: Array | None) -> bool:
    return (a is None) == (b is None) and (a is None or np.array_equal(a, b))
