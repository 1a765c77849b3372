# SPDX-License-Identifier: BSD-3-Clause
"""Words that options of the command line have here: each by the command line's own answer, and where there is one by a closed form."""

import math

import numpy as np
import pytest

import command_line
import fracfit
from fracfit import Model

SCENE = {"restitution": 0.6, "force": 40.0, "clearance": 0.3}
GIVEN = [f"--{name}={value}" for name, value in SCENE.items()]


def test_third_parameter_of_mittag_leffler():
    special = pytest.importorskip("scipy.special")
    z = np.array([-3.0, -0.7, 0.4, 2.0])
    # E^c_{1,1}(z) = 1F1(c; 1; z), and its derivative c 1F1(c + 1; 2; z).  The stated error is 1e-12 (1 + |E|) |z E'/E|,
    # below 1e-10 here.
    for gamma in (0.5, 2.0, 3.5):
        ours = fracfit.mittag_leffler(1.0, 1.0, z, gamma=gamma)
        np.testing.assert_allclose(ours, special.hyp1f1(gamma, 1, z), rtol=1e-10, atol=1e-10)
        slope = fracfit.mittag_leffler(1.0, 1.0, z, gamma=gamma, derivative=True)
        np.testing.assert_allclose(slope, gamma * special.hyp1f1(gamma + 1, 2, z), rtol=1e-10, atol=1e-10)
    # 1 is the function of two parameters; lists of it are broadcast, complex arguments too.
    both = fracfit.mittag_leffler(0.8, 0.8, -2.0 + 1j, gamma=[1.0, 0.5])
    assert both[0] == pytest.approx(fracfit.mittag_leffler(0.8, 0.8, -2.0 + 1j), rel=1e-12)
    said = command_line.run("mittag-leffler", "--alpha", 0.8, "--beta", 0.8, "--gamma", 0.5, "--z=-2,1")
    assert [both[1].real, both[1].imag] == pytest.approx([float(each) for each in said.split(",")], rel=1e-14)
    with pytest.raises(ValueError, match="gamma"):
        fracfit.mittag_leffler(0.5, 1.0, -1.0, gamma=-1.0)


def test_recursions_for_powers():
    ours = fracfit.approximate(0.5, (0.1, 300), tolerance=1e-4, sample_time=1e-3, amplification=3.0)
    theirs = command_line.json_of(
        "approximate", "--order", 0.5, "--band", "0.1:300", "--tolerance", 1e-4, "--sample-time", 1e-3, "--amplification", 3
    )
    digital = ours.digital
    assert digital.rates.tolist() == [each["rate"] for each in theirs["sections"]]
    assert digital.feeds.tolist() == [each["feed"] for each in theirs["sections"]]
    assert digital.taps.tolist() == theirs["digital"]["taps"]
    assert digital.max_relative_error == theirs["digital"]["max_relative_error"]
    # What the docstring says of H, by its numbers alone: the error that is told of it, on the band; 2 % between grid points.
    omega = np.geomspace(0.1, 300, 400)
    error = np.abs(digital.response(omega) / (1j * omega) ** 0.5 - 1).max()
    assert error < 1.02 * digital.max_relative_error < 1.02e-4
    above = np.linspace(300, math.pi / 1e-3, 401)[:-1]
    assert (np.abs(digital.response(above)) / above**0.5).max() < 1.02 * digital.most_amplification < 1.02 * 3.0
    # Weights of (1 - 1/z)^a/T^a are binomial: w_k = w_(k-1) (k - 1 - a)/k.
    weights = fracfit.approximate(0.3, (0.1, 30), poles=3, sample_time=0.01, discretisation="grunwald-letnikov", taps=50).digital.taps
    assert weights.size == 51
    k = np.arange(1, 51)
    np.testing.assert_allclose(weights[1:] / weights[:-1], (k - 1 - 0.3) / k, rtol=1e-12)
    assert weights[0] == pytest.approx(0.01**-0.3, rel=1e-12)
    assert fracfit.approximate(0.5, (0.1, 300), poles=4).digital is None
    with pytest.raises(ValueError, match="taps has no meaning but with discretisation 'grunwald-letnikov'"):
        fracfit.approximate(0.5, (0.1, 300), poles=4, sample_time=1e-3, taps=10)
    with pytest.raises(ValueError, match="discretisation has no meaning without sample_time"):
        fracfit.approximate(0.5, (0.1, 300), poles=4, discretisation="tustin")
    with pytest.raises(ValueError, match="half the sampling frequency"):
        digital.response([4000.0])


def test_orbits_that_basins_finds():
    found = command_line.json_of("orbits", "--restitution", 0.6, "--from", 1.38, "--to", 1.44, "--basins-at", 1.41)
    ours = fracfit.orbits(1.38, 1.44, restitution=0.6, basins_at=1.41)
    assert [each.parameter.tolist() for each in ours] == [[orbit["omega_rad_s"] for orbit in each["orbits"]] for each in found["branches"]]
    # Every motion that basins finds there has a branch of its impacts with its value; an orbit and its mirror image have one.
    motions = fracfit.basins(1.41, restitution=0.6).attractors
    assert len({each["impacts_per_period"] for each in motions}) == 2
    for motion in motions:
        of_its_kind = [each for each in ours if (each.period, each.impacts) == (motion["period"], motion["impacts_per_period"])]
        # Straight between neighbours that a branch has at either side, which are some 0.006 apart: 1 % of the value.
        near = [
            np.interp(1.41, *(column[i : i + 2][:: 1 if branch.parameter[i] <= branch.parameter[i + 1] else -1] for column in (branch.parameter, branch.response.imag)))
            for branch in of_its_kind
            for i in np.flatnonzero((branch.parameter[:-1] - 1.41) * (branch.parameter[1:] - 1.41) <= 0)
        ]
        assert any(abs(each / motion["response"].imag - 1) < 0.01 for each in near), (motion, near)
    with pytest.raises(ValueError, match="basins_at 2 lies outside"):
        fracfit.orbits(1.38, 1.44, restitution=0.6, basins_at=[1.4, 2.0])


def test_predictions_on_orbits_of_more_impacts():
    found = command_line.json_of("limit-cycles", "--controller", "20 + s", "--restitution", 0.6, "--starts", 0, "--branches")
    ours = fracfit.limit_cycles("20 + s", restitution=0.6, starts=0, branches=True)
    key = lambda each, force: (each["omega"], each[force], each["impacts"])
    assert [key(each, "force_amplitude") for each in ours.predicted] == [key(each, "force") for each in found["predictions"]]
    assert len(ours.predicted) > len(fracfit.limit_cycles("20 + s", restitution=0.6, starts=0).predicted)
    with pytest.raises(ValueError, match="free masses"):
        fracfit.limit_cycles("2 + s", load_receptance="1/(s^2 + 0.2 s)", restitution=0.6, starts=0, branches=True)


def test_constants_of_the_jump():
    options = ("--restitution", "0,0.5", "--criterion", "contact-at-rest")
    theirs = command_line.columns_of("jump-law", "--constants", *options)
    ours = fracfit.jump_law(constants=True, restitution=[0, 0.5], criterion="contact-at-rest")
    columns = ours._columns()
    np.testing.assert_array_equal(columns["similarity_constant"], theirs["similarity_constant"])
    # Bodies that rest in contact stay so up to sqrt(2), whatever the restitution.
    assert ours.rows[1]["similarity_constant"] == pytest.approx(math.sqrt(2), rel=1e-12)
    contact = ("--contact-stiffness", "1e4,1e5", "--contact-damping", "80", "--force", "10,20", "--clearance", "0.1")
    for friction in (0, 0.5):
        theirs = command_line.columns_of("jump-law", "--constants", *contact, "--friction1", friction)
        ours = fracfit.jump_law(constants=True, contact_stiffness=[1e4, 1e5], contact_damping=80, friction1=friction, force=[10, 20], clearance=0.1)
        for name in ("force_n", "clearance_m", "contact_stiffness_n_m", "stiffness_group", "similarity_constant", "exponent", "clearance_exponent"):
            np.testing.assert_array_equal(ours._columns()[name], theirs[name])
    with pytest.raises(ValueError, match="friction1 and friction2 need contact_stiffness"):
        fracfit.jump_law(friction1=1.0)
    # K Delta M2/(m F) with m = 1/2 kg.
    assert ours.rows[0]["stiffness_group"] == pytest.approx(1e4 * 0.1 / (0.5 * 10), rel=1e-14)


def test_limits_and_cross_validation_of_a_ranking(tmp_path):
    noise = np.random.default_rng(5).normal(size=(2, 24))
    exact = Model("K/(T s^a + 1)", K=2, T=0.5, a=0.7).frequency_response(np.logspace(-1, 2, 24))
    data = fracfit.FrequencyResponse(exact.omega, exact.response * (1 + 0.01 * (noise[0] + 1j * noise[1])))
    data.to_csv(tmp_path / "data.csv")
    models = ["fractional-lag", "lag", "K"]
    theirs = command_line.json_of("identify", tmp_path / "data.csv", "--models", ",".join(models), "--folds", 4, "--bound", "a=0.75:1")
    ours = fracfit.identify(fracfit.read(tmp_path / "data.csv"), models, folds=4, bounds={"a": (0.75, 1)})
    assert [each["name"] for each in ours.ranking] == [each["name"] for each in theirs["ranking"]]
    assert [each["prediction_rms"] for each in ours.ranking] == [each["prediction_rms"] for each in theirs["ranking"]]
    bounded = next(each["fit"] for each in ours.ranking if each["name"] == "fractional-lag")
    assert bounded["a"] == pytest.approx(0.75, rel=1e-9)  # the data say 0.7
    # A constant that a block is predicted by is the weighted mean of the rest: residuals |y - K|/|y| are least at
    # K = sum(y/|y|^2)/sum(1/|y|^2), its real part.
    ours = fracfit.identify(data, ["K"], folds=3, weight="relative", outliers="keep")
    y, square = data.response, 0.0
    for block in np.split(np.arange(24), 3):
        rest = np.setdiff1d(np.arange(24), block)
        constant = (y[rest].real / abs(y[rest]) ** 2).sum() / (1 / abs(y[rest]) ** 2).sum()
        square += (abs(y[block] - constant) ** 2 / abs(y[block]) ** 2).sum()
    assert ours.ranking[0]["prediction_rms"] == pytest.approx(math.sqrt(square / 48), rel=1e-9)
    with pytest.raises(ValueError, match="bounds of q: no candidate"):
        fracfit.identify(data, models, bounds={"q": (0, 1)})
    with pytest.raises(ValueError, match="folds = 25; allowed are 2 to the number of points, 24"):
        fracfit.identify(data, models, folds=25)


def test_receptances_under_a_sine_force():
    omega = [15.0, 22.0, 30.0]
    theirs = command_line.columns_of("simulate", *GIVEN, "--omega", "15,22,30", "--load-receptance", "1/(s^2 + 2 s)")
    ours = fracfit.describing_function(omega, **SCENE, load_receptance="1/(s^2 + 2 s)")
    # Compiled twice, and some compilers fuse products and sums into one rounding: some of the last bits.
    np.testing.assert_allclose(ours.response.real, theirs["re_m_per_n"], rtol=1e-13)
    assert ours.regime.tolist() == theirs["regime"]
    # That of a free mass is the mass: the same orbits, by another way.
    free = fracfit.describing_function(omega, **SCENE, protocol="two-impact")
    same = fracfit.describing_function(omega, **SCENE, drive_receptance="1/s^2")
    np.testing.assert_allclose(same.response, free.response, rtol=1e-9)
    # With contacts that take time too.
    contact = {"contact_stiffness": 2e4, "contact_damping": 50.0}
    theirs = command_line.columns_of(
        "simulate", "--force", 40, "--clearance", 0.3, "--contact-stiffness", 2e4, "--contact-damping", 50, "--omega", "15,22,30",
        "--load-receptance", "1/(s^2 + 2 s)",
    )
    ours = fracfit.describing_function(omega, force=40, clearance=0.3, load_receptance="1/(s^2 + 2 s)", **contact)
    np.testing.assert_allclose(ours.response.imag, theirs["im_m_per_n"], rtol=1e-13)
    with pytest.raises(ValueError, match="mass1 does not go with load_receptance"):
        fracfit.describing_function(omega, **SCENE, mass1=2.0, load_receptance="1/s^2")


def test_scenes_of_bodies_with_receptances(tmp_path):
    curves = [
        fracfit.describing_function(np.linspace(*band, 10), restitution=0.6, force=force, clearance=0.3, load_receptance="1/(s^2 + 2 s)").data()
        for force, band in ((20, (16, 26)), (40, (22, 36)))
    ]
    paths = [tmp_path / f"{i}.csv" for i in range(2)]
    for curve, path in zip(curves, paths):
        curve.to_csv(path)
    load, drive = "1/(s^2 + b1 s)", "1/(m2 s^2)"
    ours = fracfit.identify_scene(curves, [20, 40], load_receptance=load, drive_receptance=drive)
    theirs = command_line.json_of("identify-scene", *paths, "--force", "20,40", "--load-receptance", load, "--drive-receptance", drive)
    assert [each["name"] for each in ours.parameters] == [each["name"] for each in theirs["parameters"]] == ["b1", "m2", "clearance", "restitution"]
    np.testing.assert_allclose([each["value"] for each in ours.parameters], [each["value"] for each in theirs["parameters"]], rtol=1e-9)
    # Exact data: what they were computed with.
    np.testing.assert_allclose([ours[name] for name in ("b1", "m2", "clearance", "restitution")], [2, 1, 0.3, 0.6], rtol=1e-5)
    assert ours.combinations == [] and ours.usable
    with pytest.raises(ValueError, match="friction has no meaning with receptances"):
        fracfit.identify_scene(curves, [20, 40], load_receptance=load, friction="auto")


def test_motions_with_contacts_that_take_time():
    contact = {"contact_stiffness": 2e4, "contact_damping": 50.0, "friction1": 2.0}
    given = ["--force=40", "--clearance=0.3", *(f"--{name.replace('_', '-')}={value}" for name, value in contact.items())]
    theirs = command_line.columns_of("history", *given, "--omega", 20, "--skip", 3, "--periods", 2, "--samples", 10)
    ours = fracfit.history(20.0, force=40, clearance=0.3, skip=3, periods=2, samples=10, **contact)
    assert list(ours._columns()) == list(theirs)
    for name, column in ours._columns().items():
        assert column.tolist() == theirs[name]
    # The wall presses as hard as both masses are accelerated by it: k times the overlap less what damping takes.
    pressed = ours.contact_force > 0
    near = pressed & (ours.contact == "near")
    law = -2e4 * (ours.x2 - ours.x1) - 50.0 * (ours.v2 - ours.v1)
    np.testing.assert_allclose(ours.contact_force[near], np.maximum(law[near], 0), rtol=1e-6, atol=1e-6)
    assert near.any() and set(ours.event) > {"sample", "contact", "separation"}
    with pytest.raises(ValueError, match="friction1 has no meaning with restitution"):
        fracfit.history(20.0, restitution=0.6, friction1=1.0)
    # By its damping ratio, of two masses of 1 kg: c = 2 zeta m w.
    assert fracfit.contact_of_frequency(100.0, ratio=0.2)["contact_damping"] == pytest.approx(2 * 0.2 * 0.5 * 100, rel=1e-15)


ERRORS = {"sensor_noise": 1e-3, "force_noise": 0.1, "quantisation": 1e-4, "sensor_delay": 0.002, "clock_jitter": 1e-5, "seed": 7}


def given(words):
    return [f"--{name.replace('_', '-')}={value}" for name, value in words.items()]


def test_records_of_motions():
    for contact, scene in (({}, SCENE), ({"contact_stiffness": 2e4, "contact_damping": 50.0}, {"force": 40.0, "clearance": 0.3})):
        theirs = command_line.columns_of("history", *given(scene | contact | ERRORS), "--omega", "15,20", "--skip", 3, "--periods", 4, "--sample-time", 0.01)
        ours = fracfit.history([15.0, 20.0], **scene, **contact, skip=3, periods=4, sample_time=0.01, **ERRORS)
        assert {name: column.tolist() for name, column in ours._columns().items()} == theirs
    # Exact sensors read the motion itself; cubics between 200 rows a period err by 2.5e-9 of it.
    exact = fracfit.history(20.0, **SCENE, sample_time=0.01)
    rows = fracfit.history(20.0, **SCENE, samples=1000)
    at = np.flatnonzero(rows.event == "sample")
    motion = np.interp(exact.time, rows.time, rows.x1)  # straight between 1000 rows a period: (2 pi/1000)^2/8 of the swing
    assert at.size >= 5000 and np.abs(exact.x1 - motion).max() < 1e-5 * np.ptp(rows.x1)
    np.testing.assert_allclose(exact.force, 40 * np.cos(20 * exact.time), atol=40 * 3e-9)
    # Noise has its size: the standard deviation of 10^4 readings is known to 1/sqrt(2e4), five of these.
    long = {"periods": 400, "sample_time": 0.01}
    clean, noisy = (fracfit.history(20.0, **SCENE, **long, sensor_noise=noise) for noise in (0.0, 1e-3))
    assert np.std(noisy.x2 - clean.x2) == pytest.approx(1e-3, rel=5 / math.sqrt(2 * clean.time.size))
    assert np.abs(fracfit.history(20.0, **SCENE, **long, clip=0.05).x1).max() == 0.05
    steps = fracfit.history(20.0, **SCENE, **long, quantisation=1e-2).x1 / 1e-2
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-12)


def test_records_of_loops():
    theirs = command_line.columns_of(
        "loop", "--controller", "2 + s", "--restitution", 0.6, "--setpoint-sine", "1:0.5", "--duration", 20, "--every", 0.05, "--record", *given(ERRORS)
    )
    ours = fracfit.loop("2 + s", restitution=0.6, setpoint_sine=(1, 0.5), duration=20, every=0.05, record=True, **ERRORS)
    assert {name: column.tolist() for name, column in ours._columns().items()} == theirs
    assert ours.series("x2").output is not None and ours.series("x2").time.size == ours.time.size
    for words, said in (
        ({"sensor_noise": 1e-3}, "sensor_noise has no meaning without record"),
        ({"record": True}, "every is 0; a record needs"),
        ({"record": True, "every": 0.1, "clip": 0}, "clip is 0; allowed is above 0"),
        ({"record": True, "every": 0.1, "force_noise": math.nan}, "force_noise is nan; allowed is a finite number from 0"),
        ({"record": True, "every": 0.1, "sample_time": 0.1}, "record has no meaning with sample_time"),
    ):
        with pytest.raises(ValueError, match=said):
            fracfit.loop("2 + s", restitution=0.6, velocity2=1, duration=5, **words)
    for words, said in (
        ({"sample_time": 0.0}, "sample_time"),
        ({"seed": 3}, "seed has no meaning without sample_time"),
        ({"sample_time": 0.1, "samples": 10}, "samples has no meaning with sample_time"),
    ):
        with pytest.raises(ValueError, match=said):
            fracfit.history(20.0, restitution=0.6, **words)
    with pytest.raises(ValueError, match="omega names 2 frequencies; expected one, or sample_time"):
        fracfit.history([20.0, 30.0], restitution=0.6)


def test_curves_on_a_master_curve(tmp_path):
    omega, lag = np.logspace(-1, 1, 9), "K/(T s^a + 1)"
    paths = []
    for i, (K, T) in enumerate(((1, 1), (2, 3))):
        paths.append(tmp_path / f"{i}.csv")
        Model(lag, K=K, T=T, a=0.7).frequency_response(omega).to_csv(paths[-1])
    command_line.run("joint-fit", *paths, "--model", lag, "--shift", "both", "--master", tmp_path / "master.csv")
    lines = [line for line in (tmp_path / "master.csv").read_text().splitlines() if not line.startswith("#")]
    rows = [line.split(",") for line in lines[1:]]
    found = fracfit.joint_fit([fracfit.read(path) for path in paths], lag, shift="both").master_curve()
    assert list(found._columns()) == lines[0].split(",")
    np.testing.assert_allclose(found.omega, [float(row[0]) for row in rows], rtol=1e-12)
    np.testing.assert_allclose(found.response.imag, [float(row[2]) for row in rows], rtol=1e-12)
    np.testing.assert_allclose(found.model.real, [float(row[5]) for row in rows], rtol=1e-10)
    # Values of a lag with a = 0.7 scale by T^(1/a) in frequency: 3^(1/0.7).
    moved = found.omega[found.curve == found.curve[-1]] / found.omega_measured[found.curve == found.curve[-1]]
    np.testing.assert_allclose(moved, 3 ** (1 / 0.7), rtol=1e-6)
    with pytest.raises(ValueError, match="shift"):
        fracfit.joint_fit([fracfit.read(path) for path in paths], lag, shared=["a"]).master_curve()


def test_controllers_for_what_a_relay_shows(tmp_path):
    # Six periods of a relay on a lag with dead time 0.2 s, as steps of its exact step response, with noise of 0.5 %.
    time = np.arange(0, 8, 0.1)
    relay = np.where((time // 0.7) % 2 == 0, 1.0, -1.0)
    exact = Model("2 exp(-0.2 s)/(s + 1)").respond(time, relay, hold="zero-order").output
    output = exact + 0.005 * np.random.default_rng(9).normal(size=time.size)
    path = tmp_path / "relay.csv"
    path.write_text("time_s,input,output\n" + "\n".join(f"{t!r},{u!r},{y!r}" for t, u, y in zip(time.tolist(), relay.tolist(), output.tolist())) + "\n")
    theirs = command_line.json_of("tune", "--from-relay", path, "--crossover", 1.5, "--phase-margin", 60, "--max-sensitivity", 1.8)
    ours = fracfit.tune(from_relay=fracfit.read(path), crossover=1.5, phase_margin=math.radians(60), max_sensitivity=1.8)
    assert ours.plant == theirs["plant"]
    assert [ours.kp, ours.ki, ours.kd] == pytest.approx([theirs["controller"][name] for name in ("kp", "ki", "kd")], rel=1e-9)
    assert ours.region["max_sensitivity"] == pytest.approx(theirs["region"]["max_sensitivity"], rel=1e-9)
    # What it is for: on the true plant the bound holds.
    loop = Model("2 exp(-0.2 s)/(s + 1)") * ours.model
    omega = np.logspace(-2, 2, 2000)
    assert ours.usable and abs(1 / (1 + loop.frequency_response(omega).response)).max() < 1.8
    with pytest.raises(ValueError, match="give one of plant"):
        fracfit.tune("1/(s + 1)", from_relay=fracfit.read(path), crossover=1.5)
    with pytest.raises(ValueError, match="expected a TimeSeries"):
        fracfit.tune(from_relay=Model("1/(s + 1)").frequency_response([1.0, 2.0]), crossover=1.5)
