# SPDX-License-Identifier: BSD-3-Clause
"""Arguments as arrays that the compiled part takes: contiguous, of the machine's byte order, checked."""

from __future__ import annotations

import operator
import os
import re
from typing import Any, Mapping

import numpy as np

# With its arguments spelled out: strict checkers call an array without them partially unknown.
Array = np.ndarray[Any, np.dtype[Any]]


def _numbers(value: Any, name: str, kinds: str, what: str, dtype: type) -> Array:
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ValueError(f"{name} has masked entries; leave them out or fill them")
    try:
        array = np.asarray(value)
    except ValueError as reason:
        raise ValueError(f"{name} is no array of {what} numbers: {reason}") from None
    if array.dtype.kind == "O":
        if any(each is None for each in array.flat):
            raise ValueError(f"{name} is None, or holds it; expected {what} numbers")
        try:
            array = array.astype(dtype)
        except (TypeError, ValueError):
            raise ValueError(f"{name} holds objects that are no {what} numbers") from None
    if array.dtype.kind in "US":
        raise ValueError(f"{name} holds text; expected {what} numbers")
    if array.dtype.kind not in kinds:
        raise ValueError(f"{name} has the dtype {array.dtype}; expected {what} numbers")
    return array


def real_array(value: Any, name: str, shape: tuple[int, ...] | None = None) -> Array:
    """A one-dimensional array of doubles, or one of any shape if `shape` is ()."""
    array = _numbers(value, name, "biuf", "real", float)
    return _shaped(np.ascontiguousarray(array, dtype=np.float64), array, name, shape)


def complex_array(value: Any, name: str, shape: tuple[int, ...] | None = None) -> Array:
    """The same of complex numbers."""
    array = _numbers(value, name, "biufc", "complex", complex)
    return _shaped(np.ascontiguousarray(array, dtype=np.complex128), array, name, shape)


def _shaped(array: Array, given: Array, name: str, shape: tuple[int, ...] | None) -> Array:
    if shape == ():
        return array.reshape(-1)
    if given.ndim > 1:
        flat = ", as its ravel() has" if given.size == max(given.shape) else ""
        raise ValueError(f"{name} has the shape {given.shape}; expected one dimension{flat}")
    if shape is not None and array.shape != shape:
        raise ValueError(f"{name} has {array.size} entries; expected {shape[0]}")
    return array.reshape(-1)


def count(value: Any, name: str, most: int = 2**31 - 1) -> int:
    """A whole number from 0 to what the compiled part takes."""
    try:
        whole = operator.index(value)
    except TypeError:
        whole = -1
    if not 0 <= whole <= most:
        raise ValueError(f"{name} is {value!r}; expected a whole number, 0 or more" + (f", {most} at most" if whole > most else ""))
    return whole


def seed_number(value: Any) -> int:
    """The seed of random numbers."""
    return count(value, "seed", 2**64 - 1)


def number(value: Any, name: str) -> float:
    """One real number."""
    if type(value) is float:
        return value
    array = _numbers(value, name, "biuf", "real", float)
    if array.size != 1:
        raise ValueError(f"{name} has the shape {array.shape}; expected one number")
    return float(array.reshape(-1)[0])


def pair(value: Any, name: str) -> tuple[float, float]:
    """Two real numbers."""
    try:
        lower, upper = value
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; expected two numbers") from None
    return number(lower, name), number(upper, name)


def text(value: Any, name: str) -> str:
    """A text, where others have no meaning."""
    if not isinstance(value, str):
        raise ValueError(f"{name} is {_shown(value)}; expected a text")
    return value


def _shown(value: Any) -> str:
    """A value in a message: an array by its type alone."""
    return f"of the type {type(value).__name__}" if np.ndim(value) else repr(value)


def flag(value: Any, name: str) -> bool:
    """True or False, where the truth of anything else would be taken for an answer."""
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name} is {_shown(value)}; expected True or False")
    return bool(value)


def one_of(value: Any, name: str, choices: tuple[str, ...]) -> str:
    """One of some texts."""
    if text(value, name) not in choices:
        raise ValueError(f"{name} is {value!r}; expected {', '.join(choices[:-1])} or {choices[-1]}")
    return str(value)


def body_of(value: Any) -> str:
    """The body that is measured."""
    return one_of(value, "body", ("x1", "x2"))


def shape_of(values: Mapping[str, Any]) -> tuple[int, ...]:
    """The shape that arguments have when they are broadcast against each other."""
    shapes = {name: np.shape(value) for name, value in values.items()}
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        several = [f"{name} {shape}" for name, shape in shapes.items() if shape]
        raise ValueError(f"shapes do not go with each other: {', '.join(several)}") from None


def in_words(said: Any) -> str:
    """A sentence about files with the words of Python in place of the options of the command line."""
    return re.sub(r"--([a-z][a-z-]*)", lambda option: option[1].replace("-", "_"), str(said))


def path_of(value: Any, name: str) -> str:
    """The path of a file or folder."""
    if not isinstance(value, (str, os.PathLike)):
        raise ValueError(f"{name} is {value!r}; expected a path")
    return os.fspath(value)


def texts(value: Any, name: str) -> list[str]:
    """One text or several."""
    if isinstance(value, str):
        return [value]
    if not isinstance(value, (list, tuple)):
        raise ValueError(f"{name} is {value!r}; expected a text, or a list of them")
    return [text(each, name) for each in value]


def mapping(value: Any, name: str) -> Mapping[str, Any]:
    """Values by name."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise ValueError(f"{name} is {value!r}; expected values by name, such as a dict")
    return value


NO_NUMBERS = np.empty(0)
