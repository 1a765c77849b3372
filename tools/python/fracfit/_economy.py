# SPDX-License-Identifier: BSD-3-Clause
"""How many parameters a law of computed data needs."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from ._arrays import Array, complex_array, count, mapping, text
from ._fit import _described, _fitting
from ._doors import response_of
from ._model import _Record
from ._numbers import EconomyNumbers
from ._text import html_table
from ._words import named


@_described("Economy")
class Economy(_Record, EconomyNumbers):
    """What each class of models reaches with how many parameters, on data without noise.

    A parameter is a number that is adjusted: a coefficient, an order, a place.  Errors are relative, without unit: the
    root mean square over the points of ``|model - data|/|data|`` of the component.

    Attributes
    ----------
    """

    @property
    def needs(self) -> dict[str, tuple[int | None, ...]]:
        """Fewest parameters of each class, by its name, for each of `errors`; None where no number asked for suffices."""
        return {curve["name"]: tuple(curve["needs"]) for curve in self.curves}

    def points(self, name: str) -> tuple[Array, Array]:
        """Numbers of parameters and errors of a class or curve, as for a picture of one over the other."""
        for curve in self.curves:
            if curve["name"] == name:
                return np.array([p["parameters"] for p in curve["points"]]), np.array([p["error"] for p in curve["points"]])
        raise KeyError(f"no class {name!r}; there are {', '.join(self.needs)}")

    def _table(self) -> tuple[list[str], list[tuple[str, ...]]]:
        head = ["parameters needed", *(f"to {100 * error:g} %" for error in self.errors)]
        rows = []
        for curve in self.curves:
            given = curve["class"] == "given"
            none = "never" if given else f"> {self.most_parameters}"
            rows.append((curve["name" if given else "description"], *(none if n is None else str(n) for n in curve["needs"])))
        return head, rows

    def __repr__(self) -> str:
        head, rows = self._table()
        widths = [max(map(len, column)) for column in zip(head, *rows)]
        lines = ["  ".join(cell.ljust(width) if i == 0 else cell.rjust(width) for i, (cell, width) in enumerate(zip(row, widths))) for row in [head, *rows]]
        return "\n".join([*lines, self.sentence])

    def _repr_html_(self) -> str:
        head, rows = self._table()
        return html_table(head, rows, self.sentence)


@named
def economy(
    data: Any,
    *,
    component: str = "both",
    most_parameters: int = 8,
    largest_power: int = 9,
    curves: Mapping[str, Any] | None = None,
    threads: int = 0,
) -> Economy:
    """How closely each class of models follows data without noise, such as computed ones, and with how many parameters.

    Where there is no noise every class follows the data as closely as one likes, and the question is at what price.  Data
    with noise are followed below their noise by following the noise; of those `identify` tells what they support.

    Parameters
    ----------
    data : FrequencyResponse
        Computed data.
    component : {"both", "imaginary", "real"}
        Part that is followed, and that errors are relative to; nowhere 0.
    most_parameters : int
        1 to 8.
    largest_power : int
        Powers lie between minus this and this, whole or not; 1 to 9.
    curves : mapping of str to array_like, optional
        Curves that are adjusted to nothing, by their values at the frequencies of the data.
    threads : int
        0 for one per core; no influence on results.

    Raises
    ------
    ValueError
        A number is out of range, or the component is 0 at a point, where no relative error exists.

    Examples
    --------
    Two masses that meet twice a period: Im(-1/N) is (pi/8) omega^2, and nothing else.

    >>> import fracfit, numpy as np
    >>> curve = fracfit.describing_function(np.linspace(19.1, 35, 30), restitution=0.6, force=40, clearance=0.3)
    >>> found = fracfit.economy(curve.data().minus_inverse(), component="imaginary", most_parameters=2)
    >>> found.needs["integer-powers-of-omega"]
    (1, 1, 1)
    >>> found.curves[2]["points"][0]["model"]
    '0.3926991 omega^2'
    """
    data = response_of(data)
    given = {name: complex_array(value, name) for name, value in mapping(curves or {}, "curves").items()}
    return Economy(
        _fitting.economy(
            data._arrays(),
            given,
            text(component, "component"),
            count(most_parameters, "most_parameters"),
            count(largest_power, "largest_power"),
            count(threads, "threads"),
        )
    )
