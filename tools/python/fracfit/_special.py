# SPDX-License-Identifier: BSD-3-Clause
"""Mittag-Leffler function and fractional derivatives of samples."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._arrays import Array, complex_array, flag, number, real_array, shape_of
from ._words import named


@named
def mittag_leffler(alpha: Any, beta: Any, z: Any, *, gamma: Any = 1.0, derivative: bool = False) -> Any:
    """Mittag-Leffler function ``sum_k (gamma)_k z^k / (k! Gamma(alpha k + beta))``, or its derivative by z.

    Parameters
    ----------
    alpha, beta : array_like
        Orders, ``0 < alpha <= 100`` and ``|beta| <= 50``.
    z : array_like of float or complex
        Arguments; all are broadcast against each other.
    gamma : array_like
        Third parameter (Prabhakar), above 0 to 100: 1 is the function of two.  Another takes ``alpha`` up to 2.
    derivative : bool

    Returns
    -------
    float, complex or ndarray

    Examples
    --------
    >>> from fracfit import mittag_leffler
    >>> round(mittag_leffler(1, 1, -1.0), 12), round(mittag_leffler(0.5, 1, -3.0), 12)
    (0.367879441171, 0.179001151181)
    >>> mittag_leffler(0.5, 1, [-3, -2, -1]).round(6)
    array([0.179001, 0.255396, 0.427584])
    >>> round(mittag_leffler(1, 1, 1.0, gamma=2), 12)  # (1 + z) exp(z)
    5.436563656918
    """
    is_complex = np.iscomplexobj(z)
    convert = complex_array if is_complex else real_array
    points = convert(z, "z", ())
    derivative = flag(derivative, "derivative")
    shapes = np.shape(alpha), np.shape(beta), np.shape(z), np.shape(gamma)
    shape = shape_of({"alpha": alpha, "beta": beta, "z": z, "gamma": gamma})
    thirds = real_array(gamma, "gamma", ())
    has_two = bool((thirds == 1).all())
    if shapes[:2] == ((), ()) and has_two and not derivative and shape:
        values = _core.mittag_leffler_points(number(alpha, "alpha"), number(beta, "beta"), points)
        return values.reshape(shape)

    def spread(array: Array, own: tuple[int, ...]) -> Array:
        return np.ascontiguousarray(np.broadcast_to(array.reshape(own), shape)).reshape(-1)

    orders = [spread(real_array(each, name, ()), own) for each, name, own in zip((alpha, beta), ("alpha", "beta"), shapes)]
    arguments = spread(points, shapes[2])
    if has_two:
        values = _core.mittag_leffler(*orders, arguments, derivative)
    else:
        third = spread(thirds, shapes[3])
        # d/dz E^c_{a,b} = c E^(c+1)_{a,a+b}, term by term.
        last = (orders[0], orders[0] + orders[1], third + 1) if derivative else (*orders, third)
        values = _core.prabhakar(*last, arguments)
        values = third * values if derivative else values
    return values.reshape(shape) if shape else values[0].item()


@named
def derivative(samples: Any, order: float, sample_time: float, *, tolerance: float = 1e-12) -> Array:
    """Fractional derivative (order > 0) or integral (order < 0) of samples that were 0 before the first.

    By the Gruenwald-Letnikov sum with its whole memory, at a cost per sample that does not grow.

    Parameters
    ----------
    samples : array_like
        Values at equal distances in time.
    order : float
        -20 to 20.
    sample_time : float
        In seconds.
    tolerance : float
        Largest relative error of a weight of the sum.

    Examples
    --------
    >>> import fracfit
    >>> fracfit.derivative([1, 1, 1, 1], 0.5, 1.0)
    array([1.    , 0.5   , 0.375 , 0.3125])
    """
    values = real_array(samples, "samples")
    if not np.isfinite(values).all():
        at = int(np.flatnonzero(~np.isfinite(values))[0])
        raise ValueError(f"samples[{at}] is {values[at]}; expected finite numbers")
    return _core.derivative(values, number(order, "order"), number(sample_time, "sample_time"), number(tolerance, "tolerance"))
