# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of any layout, length, type and content, and data made of them."""

import os
import pickle

import command_line
import numpy as np
import pytest

import fracfit
from fracfit import FrequencyResponse, Model, TimeSeries

MODEL = Model("2/(0.5 s^0.7 + 1)")
OMEGA = np.logspace(-2, 2, 30)
EXPECTED = MODEL.frequency_response(OMEGA).response


@pytest.mark.parametrize(
    "omega",
    [
        OMEGA.astype(">f8"),
        np.repeat(OMEGA, 3)[::3],
        OMEGA[::-1][::-1],
        OMEGA.astype(np.longdouble),
        list(OMEGA),
        tuple(OMEGA),
        np.array(list(OMEGA), dtype=object),
    ],
    ids=["big-endian", "strided", "reversed twice", "long double", "list", "tuple", "objects"],
)
def test_layout_and_type_make_no_difference(omega):
    assert np.array_equal(MODEL.frequency_response(omega).response, EXPECTED)


def test_negative_strides_and_big_endian_complex():
    backwards = FrequencyResponse(OMEGA[::-1], EXPECTED[::-1])
    assert np.array_equal(backwards.omega, OMEGA)
    assert np.array_equal(backwards.response, EXPECTED)
    assert FrequencyResponse(OMEGA.astype(">f8"), EXPECTED.astype(">c16")) == backwards


def test_single_precision_is_taken_as_it_is():
    omega = OMEGA.astype(np.float32)
    assert np.array_equal(MODEL.frequency_response(omega).omega, omega.astype(float))


@pytest.mark.parametrize(
    "omega, sentence",
    [
        ([[1.0, 2.0]], "shape"),
        ([1 + 1j], "complex"),
        (["a"], "expected real"),
        ([object()], "objects"),
        ([[1.0], [1.0, 2.0]], "real"),
        ([1.0, np.nan], "omega"),
        ([1.0, np.inf], "omega"),
        ([-1.0], "omega"),
        ([], "empty|no|omega"),
        (np.array(["2020-01-01"], dtype="datetime64[D]"), "datetime64"),
        (np.ma.masked_less([1.0, 2.0], 1.5), "masked"),
    ],
)
def test_what_is_no_list_of_frequencies_is_refused(omega, sentence):
    with pytest.raises(ValueError, match=sentence):
        MODEL.frequency_response(omega)


def test_data_are_checked_with_our_sentences():
    with pytest.raises(ValueError, match="response"):
        FrequencyResponse([1.0, 2.0], ["a", "b"])
    with pytest.raises(ValueError):
        FrequencyResponse([1.0, 2.0], [1.0])
    with pytest.raises(ValueError, match="1"):
        FrequencyResponse([1.0, 2.0], [1.0, np.nan])
    with pytest.raises(ValueError, match="sigma"):
        FrequencyResponse([1.0, 2.0], [1.0, 1.0], [1.0, -1.0])
    with pytest.raises(ValueError, match="time"):
        TimeSeries([0.0, 0.0], [1.0, 1.0], [0.0, 0.0])
    with pytest.raises(ValueError, match="hold"):
        TimeSeries([0.0, 1.0], [1.0, 1.0], [0.0, 0.0], hold="cubic")


def test_data_do_not_follow_the_callers_array_and_cannot_be_changed():
    omega = OMEGA.copy()
    data = FrequencyResponse(omega, EXPECTED)
    omega[0] = 5
    assert data.omega[0] == OMEGA[0]
    with pytest.raises(ValueError):
        data.response[0] = 0


def test_a_million_points():
    omega = np.linspace(0.1, 100, 1_000_000)
    data = MODEL.frequency_response(omega)
    assert data.size == omega.size
    assert data.response[0] == MODEL(0.1j)
    values = fracfit.mittag_leffler(0.7, 1, -omega)
    # Completely monotone (Pollard 1948): falls from 1 to 0.
    assert np.all(np.diff(values) < 0) and values[-1] > 0
    s = 1.0 + 1j * omega
    assert np.max(np.abs(Model("1/(s + 1)")(s) * (s + 1) - 1)) < 1e-13
    samples = fracfit.derivative(np.ones(1_000_000), -1, 0.5)
    # The sum of ones.
    assert samples[-1] == 500_000


def test_where_and_units():
    data = FrequencyResponse.from_hz([3.0, 1.0, 2.0], [1 - 1j, 2 + 1j, 3 - 2j], [0.3, 0.1, 0.2])
    assert np.allclose(data.f, [1, 2, 3], rtol=1e-15)
    assert data.sigma.tolist() == [0.1, 0.2, 0.3]
    kept = data.where("im<0", data.f < 2.5)
    assert kept.response.tolist() == [3 - 2j]
    assert kept.sigma.tolist() == [0.2]
    assert data.where("f>1.5").size == 2
    with pytest.raises(ValueError, match="expected"):
        data.where("colour==3")
    with pytest.raises(ValueError, match="mask|bool"):
        data.where([1, 2, 3])


def test_points_are_chosen_as_those_of_an_array():
    data = FrequencyResponse([1, 2, 4, 8], [1 - 1j, 2, 3, 4j], sigma=[0.1, 0.2, 0.3, 0.4], unit="ohm")
    for points in (slice(1, 3), slice(None, None, -1), [0, 3], np.array([True, False, False, True])):
        kept = np.sort(np.arange(4)[points])
        assert data[points] == FrequencyResponse(data.omega[kept], data.response[kept], data.sigma[kept])
        assert data[points].unit == "ohm"
    assert data[-1].omega.tolist() == [8]
    with pytest.raises(IndexError):
        data[4]


def test_data_pickle_and_compare():
    data = FrequencyResponse(OMEGA, EXPECTED, np.ones(30), unit="ohm", metadata={"cell": "A"})
    again = pickle.loads(pickle.dumps(data))
    assert again == data and again.unit == "ohm" and again.metadata == {"cell": "A"}
    assert FrequencyResponse(OMEGA, EXPECTED) != data
    series = TimeSeries([0, 1, 2], [0, 1, 1], [0, 0, 0.5], hold="first-order")
    assert pickle.loads(pickle.dumps(series)) == series
    assert "30 points" in repr(data) and "ohm" in repr(data)


def test_reads_files():
    cell = fracfit.read(os.path.join(command_line.DATA, "examples", "cell.csv"))
    rows = np.loadtxt(os.path.join(command_line.DATA, "examples", "cell.csv"), delimiter=",", skiprows=3)
    rows = rows[np.argsort(rows[:, 0])]
    assert np.allclose(cell.f, rows[:, 0], rtol=1e-15)
    assert np.array_equal(cell.response, rows[:, 1] + 1j * rows[:, 2])
    assert cell.unit == "ohm"
    step = fracfit.read(os.path.join(command_line.DATA, "examples", "step.csv"))
    assert isinstance(step, TimeSeries) and step.time[1] == 0.25
    assert fracfit.read(os.path.join(command_line.DATA, "examples", "cell.csv"), where="f<1").size == np.sum(rows[:, 0] < 1)


def test_reads_one_of_several_sweeps(tmp_path):
    path = tmp_path / "two.csv"
    path.write_text("omega_rad_s,re_a,im_a,re_b,im_b\n1,1,2,3,4\n2,5,6,7,8\n")
    assert fracfit.sweep_names(path) == ["a", "b"]
    assert fracfit.read(path, select="b").response.tolist() == [3 + 4j, 7 + 8j]


def test_a_file_that_cannot_be_read(tmp_path):
    with pytest.raises(RuntimeError, match="missing.csv"):
        fracfit.read(tmp_path / "missing.csv")
    bad = tmp_path / "bad.csv"
    bad.write_text("omega,re,im\n1,2,3\n2,x,4\n")
    with pytest.raises(RuntimeError, match="bad.csv:3"):
        fracfit.read(bad)
