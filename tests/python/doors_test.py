# SPDX-License-Identifier: BSD-3-Clause
"""Data and models of other packages, in and out again: the same numbers, or one sentence."""

import pickle
import types

import numpy as np
import pytest

import fracfit
from fracfit import FrequencyResponse, Model, TimeSeries

F = np.logspace(-1, 3, 25)
Z = 10 + 50 / (1 + 0.025 * (2j * np.pi * F) ** 0.8)
DATA = FrequencyResponse.from_hz(F, Z, unit="ohm")
MODEL = "R0 + R1/(T s^a + 1)"
EXPECTED = fracfit.fit(DATA, MODEL).parameters


def test_two_arrays_are_frequencies_in_hertz_and_values():
    assert fracfit.fit(F, Z, MODEL).parameters == EXPECTED
    assert fracfit.fit(list(F), list(Z), MODEL).parameters == EXPECTED
    assert fracfit.fit(F, Z, grow="arcs").usable
    assert fracfit.validate(F, Z).noise == fracfit.validate(DATA).noise
    assert fracfit.drt(F, Z).kernel == "falling"


def test_tables_with_named_columns():
    columns = {"f_Hz": F, "re_ohm": Z.real, "im_ohm": Z.imag}
    structured = np.rec.fromarrays(list(columns.values()), names=",".join(columns))
    for table in (columns, structured, {"f_Hz": F, "Z": Z}):
        assert fracfit.fit(table, MODEL).parameters == EXPECTED
    magnitude = {"omega_rad_s": DATA.omega, "magnitude_ohm": np.abs(Z), "phase_deg": np.degrees(np.angle(Z))}
    np.testing.assert_allclose(list(fracfit.fit(magnitude, MODEL).parameters.values()), list(EXPECTED.values()), rtol=1e-9)
    samples = {"time_s": np.arange(5.0), "input": np.ones(5), "output": 1 - np.exp(-np.arange(5.0))}
    assert abs(fracfit.fit(samples, "1/(T s + 1)", offset=0.0)["T"] - 1) < 1e-9
    with pytest.raises(ValueError, match="the table"):
        fracfit.fit({"colour": F, "taste": Z.real}, MODEL)
    with pytest.raises(ValueError, match="one dimension"):
        fracfit.fit({"f_Hz": F, "re": np.ones((25, 2)), "im": F}, MODEL)


def test_pandas(tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"f_Hz": F, "re_ohm": Z.real, "im_ohm": Z.imag})
    assert fracfit.fit(frame, MODEL).parameters == EXPECTED
    assert fracfit.fit(frame.set_index("f_Hz"), MODEL).parameters == EXPECTED
    assert fracfit.batch([frame, frame], MODEL).parameters["a"].tolist() == [EXPECTED["a"]] * 2
    again = DATA.to_dataframe()
    assert list(again) == ["omega_rad_s", "re_ohm", "im_ohm"]
    assert fracfit.fit(again, MODEL).parameters == EXPECTED
    result = fracfit.fit(frame, MODEL)
    table = result.to_dataframe()
    assert table.parameter.tolist() == list(EXPECTED) and table.value.tolist() == list(EXPECTED.values())
    assert table.unit.tolist()[:2] == ["ohm", "ohm"]
    points = result.points().to_dataframe()
    np.testing.assert_array_equal(points.residual_re + 1j * points.residual_im, result.residuals)
    for thing in (
        fracfit.validate(frame),
        fracfit.drt(frame),
        fracfit.identify(frame, ["zarc", "rc"]),
        fracfit.batch([frame], MODEL),
        fracfit.describing_function([20.0, 30.0], restitution=[0.5, 0.6], force=40, clearance=0.3),
        Model("1/(s + 1)").step([0, 1, 2]),
        result.band([1.0, 2.0]),
        fracfit.joint_fit([frame, frame], MODEL, each=["T"]),
        fracfit.limit_cycles("1 + s^0.5", restitution=0.6, starts=0),
        fracfit.orbits(2.4, 2.5, restitution=0.6)[0],
        fracfit.multisine((1, 20), period=10, sample_time=0.1),
        fracfit.stepped_sine_plan((1, 20, 3), 1000),
    ):
        made = thing.to_dataframe()
        assert len(made) > 0
        thing.to_csv(tmp_path / "table.csv")
        written = pandas.read_csv(tmp_path / "table.csv", comment="#", float_precision="round_trip")
        assert list(written) == list(made)
        for name in made:
            if made[name].dtype.kind == "f":
                np.testing.assert_array_equal(written[name].astype(float), made[name])


def test_xarray():
    xarray = pytest.importorskip("xarray")
    array = xarray.DataArray(Z, dims="frequency", coords={"frequency": ("frequency", F, {"units": "Hz"})}, attrs={"units": "ohm"})
    assert fracfit.fit(array, MODEL).parameters == EXPECTED
    assert fracfit.fit(array, MODEL).data.unit == "ohm"
    back = DATA.to_xarray()
    np.testing.assert_array_equal(back.values, DATA.response)
    assert back.attrs["units"] == "ohm" and back.omega.attrs["units"] == "rad/s"
    assert fracfit.fit(back, MODEL).parameters == EXPECTED
    dataset = xarray.Dataset({"re_ohm": ("f_Hz", Z.real), "im_ohm": ("f_Hz", Z.imag)}, coords={"f_Hz": F})
    assert fracfit.fit(dataset, MODEL).parameters == EXPECTED
    with pytest.raises(ValueError, match="unit of frequency"):
        fracfit.fit(xarray.DataArray(Z, dims="x", coords={"x": F}), MODEL)
    assert set(fracfit.drt(DATA).to_xarray().data_vars) >= {"density_ohm"}


def test_responses_of_control():
    frd = types.SimpleNamespace(omega=DATA.omega, fresp=Z.reshape(1, 1, -1))
    np.testing.assert_allclose(list(fracfit.fit(frd, MODEL).parameters.values()), list(EXPECTED.values()), rtol=1e-9)
    newer = types.SimpleNamespace(omega=DATA.omega, frdata=Z.reshape(1, 1, -1))
    np.testing.assert_array_equal(fracfit.validate(newer).data.response, Z)
    with pytest.raises(ValueError, match="one input and one output"):
        fracfit.fit(types.SimpleNamespace(omega=DATA.omega, fresp=np.ones((2, 1, 25))), MODEL)


def same_response(model, other, omega=np.logspace(-2, 2, 9), rtol=1e-13):
    # A handful of products and sums, none of which cancels here.
    np.testing.assert_allclose(model(1j * omega), other, rtol=rtol)


def test_systems_of_scipy():
    signal = pytest.importorskip("scipy.signal")
    omega = np.logspace(-2, 2, 9)
    transfer = signal.TransferFunction([2, -1], [1, 3, 4])
    expected = (2j * omega - 1) / ((1j * omega) ** 2 + 3j * omega + 4)
    zpk = transfer.to_zpk()
    for system in (transfer, zpk, transfer.to_ss(), ([2, -1], [1, 3, 4]), (zpk.zeros, zpk.poles, zpk.gain)):
        same_response(Model(system), expected)
    back = Model("(2 s - 1)/(s^2 + 3 s + 4)").scipy()
    np.testing.assert_array_equal(back.num, [2, -1])
    np.testing.assert_array_equal(back.den, [1, 3, 4])
    same_response(Model(([1e-12, 5], [1, 0])), (1e-12j * omega + 5) / (1j * omega))
    half = fracfit.approximate(0.5, (0.01, 100), tolerance=1e-2)
    # Of both the error that is stated.
    for system in (half.scipy(), Model(half)):
        at = Model(system) if not isinstance(system, Model) else system
        assert np.max(np.abs(at(1j * omega) / np.sqrt(1j * omega) - 1)) <= half.max_relative_error * 1.001
    small = Model("1/(s^0.5 + 1)").realise((0.01, 100), 1e-2)
    assert np.max(np.abs(Model(small.scipy())(1j * omega) * (np.sqrt(1j * omega) + 1) - 1)) <= 1.01e-2
    for wrong, sentence in (
        (signal.TransferFunction([1], [1, 0.5], dt=0.1), "sampled every 0.1 s"),
        (([1], [0]), "denominator is 0"),
        (([], [1j], 1), "without its conjugate"),
        (np.ones(3), "expected a text"),
    ):
        with pytest.raises(ValueError, match=sentence):
            Model(wrong)
    for fractional in ("1/(s^0.5 + 1)", "exp(-s)/(s + 1)"):
        with pytest.raises(ValueError, match="realise"):
            Model(fractional).scipy()


def test_systems_of_control():
    control = pytest.importorskip("control")
    omega = np.logspace(-2, 2, 9)
    expected = 2 / ((1j * omega) ** 2 + 3j * omega + 4)
    system = control.tf([2], [1, 3, 4])
    same_response(Model(system), expected)
    same_response(Model(control.ss(system)), expected)
    assert fracfit.tune(system, crossover=0.5, phase_margin=1.0, structure="pi").usable
    np.testing.assert_allclose(Model("2/(s^2 + 3 s + 4)").control()(1j * omega), expected, rtol=1e-13)
    frd = DATA.control()
    np.testing.assert_array_equal(FrequencyResponse(frd.omega, np.asarray(frd.fresp).reshape(-1)).response, Z)
    assert fracfit.fit(frd, MODEL).parameters.keys() == EXPECTED.keys()
    time, inputs = np.linspace(0, 5, 51), np.ones(51)
    record = control.forced_response(system, time, inputs)
    assert abs(fracfit.fit(record, "K/(s^2 + b s + c)", offset=0.0)["K"] - 2) < 0.01  # an input straight between samples or held is the same
    for made in (fracfit.approximate(0.5, (0.01, 100), poles=5), Model("1/(s^0.5 + 1)").realise((0.01, 100), 1e-2)):
        assert np.all(np.isfinite(made.control()(1j * omega)))


def test_words_of_the_command_line():
    by_name = fracfit.fit(DATA, MODEL, fixed={"R0": 10}, bounds={"a": (0.5, 1)}, start={"T": 0.02}, prior={"R1": (50, 5)})
    for words in (
        {"fix": {"R0": 10}, "bound": {"a": (0.5, 1)}, "start": "T=0.02", "prior": "R1=50+-5"},
        {"fix": "R0=10", "bound": "a=0.5:1", "start": ["T=0.02"], "prior": ["R1=50+-5"]},
        {"fix": ["R0 = 10"], "bound": {"a": "0.5:1"}, "start": {"T": "0.02"}, "prior": {"R1": "50+-5"}},
    ):
        assert fracfit.fit(DATA, MODEL, **words) == by_name
    open_end = fracfit.fit(DATA, MODEL, bound="R1=0:")
    assert open_end.limits["R1"] == (0, np.inf)
    assert fracfit.batch([DATA], MODEL, fix="R0=10").results[0]["R0"] == 10
    for wrong, sentence in (
        ({"fix": "R0"}, "NAME=VALUE"),
        ({"bound": "a=0.5"}, "lower, upper"),
        ({"fix": {"R0": 1}, "fixed": {"R0": 1}}, "give one of them"),
        ({"fix": ["R0=1", "R0=2"]}, "R0 twice"),
    ):
        with pytest.raises(ValueError, match=sentence):
            fracfit.fit(DATA, MODEL, **wrong)


def test_derived_quantities_come_with_the_fit():
    result = fracfit.fit(DATA, MODEL, derive=["f1 = 1/(2 pi T)", "R = R0 + R1"])
    assert [each["name"] for each in result.derived] == ["f1", "R"]
    assert result.derived[0] == result.derive("f1 = 1/(2 pi T)")
    assert pickle.loads(pickle.dumps(result)).derived == result.derived
    assert "f1" in result._repr_html_()


def test_residuals_are_those_of_every_point():
    spoilt = Z.copy()
    spoilt[10] *= 1.5
    noise = np.random.default_rng(5).normal(size=(2, 25))
    data = FrequencyResponse.from_hz(F, spoilt * (1 + 1e-3 * (noise[0] + 1j * noise[1])), unit="ohm")
    with pytest.warns(UserWarning):
        result = fracfit.fit(data, MODEL)
    assert result.left_out == [10] and result.residuals.size == data.size
    np.testing.assert_array_equal(result.residuals, result.predict() - data.response)
    assert np.argmax(np.abs(result.residuals)) == 10
    assert result.points().left_out.nonzero()[0].tolist() == [10]
    assert result.residual_count == 48
    record = TimeSeries(np.arange(6.0), np.ones(6), 1 - np.exp(-np.arange(6.0)))
    over_time = fracfit.fit(record, "1/(T s + 1)", offset=0.0)
    assert np.max(np.abs(over_time.residuals)) < 1e-8
    assert list(over_time.points()._columns()) == ["time_s", "output", "fit", "residual"]


@pytest.mark.parametrize("unit", ["ohm", "m/N", "N/m", ""])
def test_files_that_are_written_read_back_the_same(tmp_path, unit):
    data = FrequencyResponse(DATA.omega, Z, np.full(25, 0.1), unit=unit, metadata={"cell": "A"})
    data.to_csv(tmp_path / "data.csv")
    again = fracfit.read(tmp_path / "data.csv", weight_column="sigma" if not unit else None)
    assert np.array_equal(again.omega, data.omega) and np.array_equal(again.response, data.response)
    assert again.unit == unit and again.metadata["cell"] == "A"
    assert again.sigma is None or np.array_equal(again.sigma, data.sigma)
    record = TimeSeries(np.arange(3.0), [0, 1, 1], [0, 0.3, 0.5])
    record.to_csv(tmp_path / "record.csv")
    assert fracfit.read(tmp_path / "record.csv") == record


def test_data_are_no_sequence_but_say_their_size():
    omega, response = DATA
    assert np.array_equal(omega, DATA.omega) and np.array_equal(response, DATA.response)
    assert DATA.size == 25 and bool(DATA) and DATA[2:5].size == 3 and DATA[3].size == 1
    with pytest.warns(DeprecationWarning, match="size"):
        assert len(DATA) == 25
    with pytest.raises(IndexError, match="25 points"):
        DATA[25]
    with pytest.raises(ValueError, match="no point"):
        DATA[5:5]


def test_pictures(tmp_path):
    plt = pytest.importorskip("matplotlib.pyplot")
    result = fracfit.fit(DATA, MODEL)
    figure, axes = plt.subplots(2, 3)
    assert fracfit.plot_bode(DATA, ax=axes[:, 0]).tolist() == axes[:, 0].tolist()
    upper, lower = DATA.plot(ax=axes[0, 1])
    assert upper is axes[0, 1] and lower.get_ylabel() == "phase, deg"
    # The arc of an impedance hangs above the axis, its values below.
    nyquist = result.plot(kind="nyquist", ax=axes[1, 1])
    assert nyquist is axes[1, 1] and nyquist.get_ylabel() == "-Im, ohm"
    assert all(np.all(line.get_ydata() >= 0) for line in nyquist.lines) and len(nyquist.collections) == 1
    assert "Im" == fracfit.plot_nyquist(Model("1/(s + 1)"), omega=[1, 2, 3], ax=axes[0, 2]).get_ylabel()
    with pytest.raises(ValueError, match="expected axes of matplotlib"):
        DATA.plot(ax=3)
    record = TimeSeries(np.arange(6.0), np.ones(6), 1 - np.exp(-np.arange(6.0)))
    over_time = fracfit.fit(record, "1/(T s + 1)", offset=0.0)
    drawn = over_time.plot(ax=axes[1, 2], labels=("measured", "model"), color="red", marker="x")
    assert drawn is axes[1, 2] and drawn.lines[0].get_color() == "red" and drawn.lines[0].get_label() == "measured"
    with pytest.raises(ValueError, match="no meaning with samples over time"):
        over_time.plot(kind="nyquist")
    for thing in (fracfit.validate(DATA), fracfit.drt(DATA), Model("1/(s + 1)").step([0, 1]), record):
        assert thing.plot(ax=axes[0, 2]) is axes[0, 2]
    plt.close(figure)
    # The band holds the fit, and widens where the data end.
    noise = np.random.default_rng(5).normal(size=(2, 25))
    noisy = FrequencyResponse.from_hz(F, Z * (1 + 0.02 * (noise[0] + 1j * noise[1])), unit="ohm")
    band = fracfit.fit(noisy, MODEL, outliers="keep").band(np.logspace(-3, 6, 50))
    assert np.all(band.re_lower < band.response.real) and np.all(band.magnitude_upper > np.abs(band.response))
    figure = fracfit.fit(noisy, MODEL, outliers="keep").plot()[0].figure
    figure.savefig(tmp_path / "bode.png")
    assert len(figure.axes[0].collections) == 1
    plt.close(figure)


def test_tables_of_notebooks_have_units_and_a_headline():
    shown = fracfit.fit(DATA, MODEL)._repr_html_()
    assert "<td>ohm</td>" in shown and MODEL in shown and "rms" in shown
    assert "ohm" in DATA._repr_html_() and "f, Hz" in DATA._repr_html_()
    for thing in (fracfit.validate(DATA), fracfit.drt(DATA), fracfit.history(2.0, restitution=0.5), fracfit.joint_fit([DATA, DATA], MODEL, each="T")):
        assert "<strong>" in thing._repr_html_()
