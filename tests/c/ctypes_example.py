# SPDX-License-Identifier: BSD-3-Clause
"""fracfit from a language that calls C: a fit with its intervals, by ctypes and nothing else.

usage: ctypes_example.py LIBRARY      such as /usr/local/lib/libfracfit.so"""

import ctypes
import sys

library = ctypes.CDLL(sys.argv[1])
for name in ("fracfit_error", "fracfit_fit_parameter_name"):
    getattr(library, name).restype = ctypes.c_char_p
for name in ("fracfit_model_create", "fracfit_fit_create"):
    getattr(library, name).restype = ctypes.c_void_p
for name in ("fracfit_model_destroy", "fracfit_fit_destroy"):
    getattr(library, name).argtypes = [ctypes.c_void_p]
library.fracfit_fit_parameter_count.restype = ctypes.c_size_t


def array(numbers):
    return (ctypes.c_double * len(numbers))(*numbers)


def created(handle):
    if not handle:
        raise ValueError(library.fracfit_error().decode())
    return ctypes.c_void_p(handle)


def fit(formula, omega, response):
    """Value and 95 % interval of each parameter."""
    model = created(library.fracfit_model_create(formula.encode()))
    re, im = array([each.real for each in response]), array([each.imag for each in response])
    count = ctypes.c_size_t(len(omega))
    try:
        result = created(library.fracfit_fit_create(model, array(omega), re, im, None, count, None))
    finally:
        library.fracfit_model_destroy(model)
    found = {}
    for index in range(library.fracfit_fit_parameter_count(result)):
        at = ctypes.c_size_t(index)
        value, lower, upper = ctypes.c_double(), ctypes.c_double(), ctypes.c_double()
        pointers = map(ctypes.byref, (lower, upper))
        library.fracfit_fit_parameter(result, at, ctypes.byref(value), None, *pointers)
        found[library.fracfit_fit_parameter_name(result, at).decode()] = value.value, lower.value, upper.value
    library.fracfit_fit_destroy(result)
    return found


frequencies = [0.01 * 1.2**i for i in range(60)]
# Two parts in a thousand of error, the same number up and down.
measured = [2 / (0.5 * (1j * w) ** 0.7 + 1) * (1 + 0.002 * (-1) ** i) for i, w in enumerate(frequencies)]
for name, (value, lower, upper) in fit("K/(T s^a + 1)", frequencies, measured).items():
    print(f"{name} = {value:.4f}, 95 % within {lower:.4f} and {upper:.4f}")
try:
    fit("K/(T s^a +", frequencies, measured)
except ValueError as error:
    print(error)
