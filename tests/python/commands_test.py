# SPDX-License-Identifier: BSD-3-Clause
"""Every computing command of the program is a function here, and its numbers are those of the program to the last bit."""

import json
import math
import os
import re
import subprocess
import zipfile

import numpy as np
import pytest

import command_line
import fracfit
from fracfit import FractionalPid, Model

EXAMPLES = os.path.join(command_line.DATA, "examples")
CELL = os.path.join(EXAMPLES, "cell.csv")


def test_every_computing_command_has_its_function():
    placed = {**command_line.FUNCTIONS, **command_line.METHODS}
    assert command_line.commands() == set(placed) | command_line.TEXTS
    for where in placed.values():
        assert callable(command_line.function(where))


def same(ours, theirs):
    """To the last bit, NaN for what is not there."""
    mine, other = np.asarray(ours, dtype=float), np.asarray(theirs, dtype=float)
    assert mine.shape == other.shape
    np.testing.assert_array_equal(mine, other)


def test_validity():
    columns = command_line.columns_of("validate", CELL)
    found = fracfit.validate(fracfit.read(CELL))
    assert found.validity == columns["validity"][0]
    for name in ("noise", "noise_floor", "noise_slope", "correlation", "drift", "drift_deviation", "detectable_drift", "step", "largest_residual"):
        same(getattr(found, name), columns[name][0])
    for each in found.findings:
        same(each["p_value"], columns["p_" + each["test"].replace("-", "_")][0])
    # Its consistent model belongs to the points, and what it leaves is as large as the noise that it tells.
    rest = found.residuals[np.isfinite(found.residuals)]
    assert rest.size > 40 and 0.3 < np.sqrt(np.mean(np.abs(rest) ** 2) / 2) / found.noise < 3


def test_relaxation_times(tmp_path):
    columns = command_line.columns_of("drt", CELL)
    found = fracfit.drt(fracfit.read(CELL))
    kind = np.array(columns["kind"])
    same(found.tau, np.array(columns["tau_s"])[kind == "density"])
    same(found.density, np.array(columns["value"])[kind == "density"])
    same(found.lower, np.array(columns["lower"])[kind == "density"])
    same([each["tau"] for each in found.peaks], np.array(columns["tau_s"])[kind == "peak"])
    # Of a formula: closed form of an arc (Fuoss, Kirkwood 1941), g = sin(a pi)/(2 pi (cosh(a ln(tau/T)) + cos(a pi))).  The
    # density is the difference of two values beside the cut, each right to some 1e-15.
    tau = np.logspace(-4, 0, 41)
    exact = np.sin(0.8 * np.pi) / (2 * np.pi) / (np.cosh(0.8 * np.log(tau / 0.01)) + np.cos(0.8 * np.pi))
    arc = fracfit.drt(Model("1/(1 + (T s)^a)", T=0.01, a=0.8), tau=tau)
    np.testing.assert_allclose(arc.density, exact, rtol=1e-12)
    # An admittance rises; its density is that of the other kernel.
    assert fracfit.drt(Model("1 - 1/(1 + (0.01 s)^0.8)"), tau=tau).kernel == "rising"


def test_joint_fits(tmp_path):
    paths = [tmp_path / f"{k}.csv" for k in (1, 2)]
    random = np.random.default_rng(3)
    for k, path in enumerate(paths):
        exact = Model("K/(T s^a + 1)", K=k + 1, T=0.5, a=0.7).frequency_response(np.logspace(-1, 2, 25))
        noise = random.normal(size=(2, 25))
        data = fracfit.FrequencyResponse(exact.omega, exact.response * (1 + 0.01 * (noise[0] + 1j * noise[1])), metadata={"force": str(k + 1)})
        data.to_csv(path)
    curves = [fracfit.read(path) for path in paths]
    theirs = command_line.json_of("joint-fit", *paths, "--model", "K/(T s^a + 1)", "--shared", "T,a", "--derive", "w = T^(-1/a)")
    ours = fracfit.joint_fit(curves, "K/(T s^a + 1)", shared="T,a", derive="w = T^(-1/a)")
    assert list(ours.parameters) == [each["name"] for each in theirs["shared"]] == ["T", "a"]
    for mine, other in zip(ours.shared, theirs["shared"]):
        same([mine["value"], mine["standard_error"]], [other["value"], other["standard_error"]])
    same(ours.sharing_p_value, theirs["sharing_p_value"])
    for curve in ours.curves:
        w = curve["derived"][0]
        assert math.isclose(w["value"], ours["T"] ** (-1 / ours["a"]), rel_tol=1e-14)
        assert w["standard_error"] > 0
    # The other way round, and by a law of what the headers know: the same shared values, as K = force.
    again = fracfit.joint_fit(curves, "K/(T s^a + 1)", each=["K"])
    assert again.parameters == ours.parameters
    law = fracfit.joint_fit(curves, "K/(T s^a + 1)", shared=["T", "a"], law="K = K0 force^p")
    assert abs(law["p"] - 1) < 0.05 and abs(law["K0"] - 1) < 0.05  # with 1 % noise of 25 points
    assert ours.to_csv(tmp_path / "joint.csv") is None


def test_jump_law():
    options = {"restitution": [0.2, 0.5], "force": [10.0, 20.0, 40.0], "clearance": [0.1, 0.2]}
    theirs = command_line.json_of("jump-law", *(f"--{name}={','.join(map(str, value))}" for name, value in options.items()))
    ours = fracfit.jump_law(**options)
    same([each["omega_jump"] for each in ours.points], [each["omega_jump"] for each in theirs["points"]])
    same(ours.a_of_clearance["coefficient"], theirs["a_of_clearance"]["coefficient"])
    same(ours.mean_similarity_constant, np.mean([each["similarity_constant"] for each in ours.constants]))
    # Of contacts that take time.
    del options["restitution"]
    contact = ("--contact-stiffness", "1e4,1e5", "--contact-damping", "80")
    theirs = command_line.json_of("jump-law", *contact, *(f"--{name}={','.join(map(str, value))}" for name, value in options.items()))
    ours = fracfit.jump_law(contact_stiffness=[1e4, 1e5], contact_damping=80, **options)
    same([each["omega_jump"] for each in ours.points], [each["omega_jump"] for each in theirs["points"]])
    same(ours.b_of_clearance["exponent"], theirs["b_of_clearance"]["exponent"])


@pytest.mark.bits
def test_motions_over_time():
    scene = {"restitution": 0.6, "force": 40.0, "clearance": 0.3}
    arguments = [f"--{name}={value}" for name, value in scene.items()]
    theirs = command_line.columns_of("history", *arguments, "--omega", 20, "--skip", 1500, "--periods", 2, "--samples", 10)
    ours = fracfit.history(20.0, **scene, skip=1500, periods=2, samples=10)
    for name, column in ours._columns().items():
        if name in ("event", "contact"):
            assert column.tolist() == theirs[name]
        else:
            same(column, theirs[name])
    sensors = {"sensor_noise": 1e-3, "force_noise": 0.1, "quantisation": 5e-4, "clip": 0.2, "sensor_delay": 1e-3, "clock_jitter": 2e-5, "seed": 7}
    read = [f"--{name.replace('_', '-')}={value}" for name, value in sensors.items()]
    theirs = command_line.columns_of("history", *arguments, "--omega", "20,25", "--periods", 20, "--sample-time", 0.002, *read)
    rig = fracfit.history([20.0, 25.0], **scene, periods=20, sample_time=0.002, **sensors)
    for name, column in rig._columns().items():
        same(column, theirs[name])
    theirs = command_line.columns_of(
        "loop", "--controller", "2 + s", "--restitution", 0.6, "--setpoint-sine", "1:0.5", "--duration", 20, "--every", 0.05, "--record", *read
    )
    for name, column in fracfit.loop("2 + s", restitution=0.6, setpoint_sine=(1, 0.5), duration=20, every=0.05, record=True, **sensors)._columns().items():
        same(column, theirs[name])
    found = fracfit.response(fracfit.history([18.0, 22.0, 27.0, 33.0], **scene, periods=30, sample_time=0.002, sensor_noise=1e-3), output="x1")
    curves = [found.frequency_response(harmonic=order) for order in (1, 3, 5)]
    np.testing.assert_array_equal(curves[1].response, found.harmonics[:, 1])
    same(curves[2].sigma, found.harmonics_sigma[:, 3])
    by_all = fracfit.identify_scene(curves, [40] * 3, harmonic=[1, 3, 5], fixed={"mass1": 1})
    # Three such points of the fundamental tell the clearance to 7e-4: seven deviations.
    assert abs(by_all["clearance"] - 0.3) < 0.005
    with pytest.raises(ValueError, match="harmonic"):
        fracfit.identify_scene(curves, [40] * 3, harmonic=[1, 3], fixed={"mass1": 1})
    # Arrays of the record say the same as the record.
    whole, part = fracfit.response(rig), fracfit.response(input=rig.force, output=rig.x2, sample_time=rig.sample_time)
    np.testing.assert_array_equal(whole.response[1], part.response)
    same(fracfit.response(rig, output="x2").sigma, part.sigma)
    theirs = command_line.columns_of("loop", "--controller", "1 + s^0.5", "--restitution", 0.6, "--velocity2", 1, "--duration", 20, "--every", 0.5)
    ours = fracfit.loop("1 + s^0.5", restitution=0.6, velocity2=1, duration=20, every=0.5)
    same(ours.x1, theirs["x1_m"])
    same(ours.force, theirs["force_n"])
    sampled = fracfit.loop("2 + s^0.5", restitution=0.6, velocity2=1, duration=1, sample_time=0.002, force_limit=0.5)
    theirs = command_line.columns_of(
        "loop", "--controller", "2 + s^0.5", "--restitution", 0.6, "--velocity2", 1, "--duration", 1, "--sample-time", 0.002, "--force-limit", 0.5
    )
    same(sampled.x1, theirs["x1_m"])
    contacts = {"contact_stiffness": 300, "contact_damping": 3, "friction1": 0.01, "disturbance1": 0.02}
    sampled = fracfit.loop("2 + s", **contacts, body="x2", velocity2=1, duration=1, sample_time=0.02)
    words = [word for name, value in contacts.items() for word in ("--" + name.replace("_", "-"), value)]
    theirs = command_line.columns_of("loop", "--controller", "2 + s", *words, "--body", "x2", "--velocity2", 1, "--duration", 1, "--sample-time", 0.02)
    same(sampled.x1, theirs["x1_m"])
    same(sampled.force, theirs["force_n"])
    # A set-point by its knots is the ramp that they lie on.
    ramp = fracfit.loop("2 + s", restitution=0.6, setpoint_ramp=0.1, duration=5, every=0.5)
    knots = fracfit.loop("2 + s", restitution=0.6, setpoint=([0.0, 10.0], [0.0, 1.0]), duration=5, every=0.5)
    # Two ways to the same flight, in the sum of exponentials of whole powers: rounding, grown over a few impacts.
    np.testing.assert_allclose(knots.x1, ramp.x1, atol=1e-9)


def test_excitations():
    for lines in ("odd-random", "odd", "full"):
        theirs = command_line.columns_of(
            "multisine", "--band", "2:40", "--period", 5, "--sample-time", 0.02, "--lines", lines, "--peak", 3, "--periods", 2, "--rounds", 20, "--seed", 7
        )
        ours = fracfit.multisine((2, 40), period=5, sample_time=0.02, lines=lines, peak=3, periods=2, rounds=20, seed=7)
        for name, column in ours._columns().items():
            same(column, theirs[name])
        # What it says of itself is what is in it: sines of that amplitude at the lines, nothing else.  Sums of 250 terms round to
        # some 1e-15 of the peak.
        spectrum = 2 * np.abs(np.fft.rfft(ours.input[:250])) / 250
        expected = np.zeros(126)
        expected[ours.lines] = ours.amplitude
        np.testing.assert_allclose(spectrum, expected, atol=1e-12)


def test_stepped_sine_plan(tmp_path):
    asked = tmp_path / "identify.json"
    asked.write_text(
        '{"verdict": "undecided", "next_measurement": {"lower": 10, "upper": 40, "points": 3, "accuracy": 0.01,'
        ' "relative_accuracy": 0.02, "expected_evidence": 12}}'
    )
    theirs = command_line.columns_of("multisine", "--next-measurement", asked, "--total-time", 90, "--settling", 4)
    for name, column in fracfit.stepped_sine_plan((10, 40, 3), 90, settling=4)._columns().items():
        same(column, theirs[name])


def same_response(ours, theirs):
    """Every column that the program has, but the levels of the force, which it gathers from the amplitudes."""
    columns = ours._columns()
    assert set(columns) == set(theirs) - {"force_n"}
    for name, column in columns.items():
        same(column, theirs[name])


def test_responses_of_records(tmp_path):
    # Exact: a motion of masses with backlash, and its describing function.
    path = tmp_path / "motion.csv"
    scene = {"restitution": 0.6, "force": 40.0, "clearance": 0.3}
    asked = ["--omega", 20, "--skip", 200, "--periods", 8, "--samples", 200]
    path.write_text(command_line.run("history", *(f"--{name}={value}" for name, value in scene.items()), *asked, "--format", "csv"))
    motion = fracfit.response(path, columns="output=x1_m")
    same_response(motion, command_line.columns_of("response", path, "--columns", "output=x1_m"))
    # Input and output of two loggers, 0.3 of a step apart.
    drive, answer = tmp_path / "drive.csv", tmp_path / "answer.csv"
    for file, late, gain in ((drive, 0.0, 1), (answer, 0.003, 2)):
        time = 0.01 * np.arange(1000) + late
        file.write_text("time_s,u,y\n" + "".join(f"{t!r},{u!r},{u!r}\n" for t, u in zip(time.tolist(), (gain * np.cos(9 * time)).tolist())))
    two = fracfit.response(answer, input_file=drive)
    same_response(two, command_line.columns_of("response", answer, "--input-file", drive))
    # The frequency is found to the leakage of a sine into the halves of its record.
    np.testing.assert_allclose(two.response, 2, atol=1e-3)
    with pytest.raises(ValueError, match="input_file names 2 files"):
        fracfit.response(answer, input_file=[drive, drive])
    exact = fracfit.describing_function([20.0], **scene).response[0]
    assert motion.frequency_response().unit == "m/N"
    # Velocities jump by no more than a few of their peaks, so that harmonic k is a few 1/k^2 of the first; those beside the 200th
    # fold back onto it, 1e-4: ten times that.
    assert abs(motion.response[0] / exact - 1) < 1e-3
    # Noisy: a multisine through a lag, by arrays, by a TimeSeries, by the file.
    drive = fracfit.multisine((1, 30), period=20, sample_time=0.05, periods=5)
    random = np.random.default_rng(5)
    lag = Model("2/(0.3 s + 1)")
    answer = lag.respond(drive.time, drive.input).output + 0.02 * random.normal(size=drive.time.size)
    second = -0.5 * drive.input + 0.02 * random.normal(size=drive.time.size)
    record = fracfit.TimeSeries(drive.time, drive.input, answer)
    path = tmp_path / "noisy.csv"
    record.to_csv(path)
    theirs = command_line.columns_of("response", path)
    for ours in (fracfit.response(drive.time, drive.input, answer), fracfit.response(record), fracfit.response(path)):
        assert ours.excitation == "periodic" and ours.usable and ours.size > 20
        same_response(ours, theirs)
    # The lag under a held input, sampled.  Squares of errors over sigma have mean 1 and, of Student's distribution with the fewest
    # degrees of freedom, 9, the variance 3.2; both parts of n points: five deviations of their mean.
    data = ours.frequency_response()
    decay = np.exp(-0.05 / 0.3)
    shift = np.exp(-0.05j * data.omega)
    squares = np.abs(data.response - 2 * (1 - decay) * shift / (1 - decay * shift)) ** 2 / (2 * data.sigma**2)
    assert abs(np.mean(squares) - 1) < 5 * np.sqrt(3.2 / (2 * data.size))
    # Fits weigh with a sigma that was measured, here as on the command line.
    written = tmp_path / "n.csv"
    written.write_text(command_line.run("response", path, "--format", "csv"))
    found = command_line.json_of("fit", written, "--model", "K/(T s + 1)")
    assert found["options"]["weight"] == "given" and fracfit.read(written).sigma_is_measured
    expected = {each["name"]: each["value"] for each in found["parameters"]}
    one = fracfit.fit(data, "K/(T s + 1)")
    assert one.weight == fracfit.fit(fracfit.read(written), "K/(T s + 1)").weight == fracfit.batch([data], "K/(T s + 1)")[0].weight == "given"
    # Of the same numbers, which the file has to the last digit.
    assert all(abs(one[name] / value - 1) < 1e-9 for name, value in expected.items())
    assert fracfit.fit(data, "K/(T s + 1)", weight="learned").weight == "learned"
    assert fracfit.fit(fracfit.FrequencyResponse(data.omega, data.response, data.sigma), "K/(T s + 1)").weight == "learned"
    # Seven samples are missing.
    lines = path.read_text().splitlines(keepends=True)
    gap = tmp_path / "gap.csv"
    gap.write_text("".join(lines[:900] + lines[907:]))
    bridged = fracfit.response(gap)
    assert any("a gap of 7 samples" in remark for remark in bridged.remarks)
    same_response(bridged, command_line.columns_of("response", gap))
    for excitation, option in (("arbitrary", {}), ("stepped-sine", {"harmonics": 3}), ("periodic", {"period": 20})):
        if excitation == "stepped-sine":
            time = np.arange(4000) * 0.05
            tones = np.where(time < 100, np.cos(2 * time), 1.5 * np.cos(3.1 * time))
            path = tmp_path / "tones.csv"
            fracfit.TimeSeries(time, tones, tones + 0.1 * tones**3 + 0.01 * random.normal(size=4000)).to_csv(path)
        else:
            path = tmp_path / "noisy.csv"
        words = [word for name, value in option.items() for word in (f"--{name}", value)]
        same_response(fracfit.response(path, excitation=excitation, **option), command_line.columns_of("response", path, "--excitation", excitation, *words))
    # Two outputs, rows of each, and several records, whose mean it is.
    path = tmp_path / "two.csv"
    path.write_text("time_s,input,output1,output2\n" + "".join(f"{t!r},{u!r},{y!r},{z!r}\n" for t, u, y, z in zip(*(each.tolist() for each in (drive.time, drive.input, answer, second)))))
    theirs = command_line.columns_of("response", path)
    both = fracfit.response(path)
    same_response(both, theirs)
    same(fracfit.response(drive.time, drive.input, [answer, second]).response.imag, both.response.imag)
    again = fracfit.TimeSeries(drive.time, drive.input, second)
    again.to_csv(tmp_path / "again.csv")
    same_response(fracfit.response([record, again]), command_line.columns_of("response", tmp_path / "noisy.csv", tmp_path / "again.csv"))
    loop = fracfit.response(drive.time, answer, second, reference=drive.input, excitation="arbitrary")
    path.write_text(path.read_text().replace("input,output1,output2", "reference,input,output"))
    same_response(loop, command_line.columns_of("response", path, "--excitation", "arbitrary"))


def test_basins():
    theirs = command_line.columns_of("basins", "--restitution", 0.6, "--omega", 1.41, "--position", "0.2,0.8", "--velocity=-1,0,1")
    ours = fracfit.basins(1.41, restitution=0.6, position=[0.2, 0.8], velocity=[-1, 0, 1])
    same(ours._columns()["position_m"], theirs["position_m"])
    assert len(set(theirs["attractor"])) == len(ours.attractors)
    assert sum(each["starts"] for each in ours.attractors) == ours.attractor.size == 6


def test_controllers_for_what_data_leave_possible(tmp_path):
    data = fracfit.read(os.path.join(EXAMPLES, "step.csv"))
    fit = fracfit.fit(data, "K exp(-L s)/(T s^a + 1)")
    path = tmp_path / "fit.json"
    path.write_text(command_line.run("fit", os.path.join(EXAMPLES, "step.csv"), "--model", "K exp(-L s)/(T s^a + 1)", "--format", "json"))
    crossover = 0.5 / fit["T"]
    asked = ["--crossover", crossover, "--phase-margin", 60, "--max-sensitivity", 1.8, "--structure", "pi", "--lambda", 1]
    theirs = json.loads(subprocess.run([command_line.PROGRAM, "tune", "--fit", path, *map(str, asked)], capture_output=True, text=True, check=False).stdout)
    ours = fracfit.tune(fit, crossover=crossover, phase_margin=math.radians(60), max_sensitivity=1.8, structure="pi", lambda_=1)
    np.testing.assert_allclose(ours.kp, theirs["controller"]["kp"], rtol=1e-9)  # degrees to rad
    assert ours.region["plants"] == theirs["region"]["plants"] and ours.usable == (theirs["status"] == "met")
    # The worst of the region is no better than the plant itself.
    assert ours.region["max_sensitivity"] >= ours.max_sensitivity - 1e-9


def test_controllers_with_backlash():
    options = {"clearance": 0.01, "restitution": 0.5, "crossover": 2.0}
    theirs = command_line.json_of("tune", *(f"--{k}={v}" for k, v in options.items()), "--load-receptance", "1/(s^2 + 0.8 s)", "--phase-margin", 50)
    ours = fracfit.tune(**options, load_receptance="1/(s^2 + 0.8 s)", phase_margin=math.radians(50))
    np.testing.assert_allclose(ours.kp, theirs["controller"]["kp"], rtol=1e-6)  # a search, from degrees that round otherwise
    assert (ours.motion["swing"] > 0) == theirs["backlash"]["persists"]
    assert [each["name"] for each in ours.constraints] == [each["name"] for each in theirs["constraints"]]


def test_loops_of_contacts_that_take_time():
    contact = {"contact_stiffness": 450.0, "contact_damping": 5.4, "friction1": 0.02, "friction2": 0.01}
    words = [f"--{name.replace('_', '-')}={value}" for name, value in contact.items()]
    theirs = command_line.columns_of("loop", "--controller", "1 + 0.3 s", *words, "--velocity2", 1, "--duration", 10, "--every", 0.5)
    ours = fracfit.loop("1 + 0.3 s", **contact, velocity2=1, duration=10, every=0.5)._columns()
    for name in ("x1_m", "v2_m_s", "force_n", "contact_force_n"):
        same(ours[name], theirs[name])
    assert list(ours["event"]) == list(theirs["event"]) and list(ours["contact"]) == list(theirs["contact"])
    theirs = command_line.json_of("limit-cycles", "--controller", "1 + 0.3 s", *words)
    found = fracfit.limit_cycles("1 + 0.3 s", **contact)
    same([each["omega"] for each in found.cycles], [each["omega"] for each in theirs["cycles"]])
    assert [each["stable"] for each in found.cycles] == [each["stable"] for each in theirs["cycles"]]
    assert found.rests == pytest.approx((-0.03, 0.03))  # (F1 + F2)/C(0) of free masses
    last = found.cycles[-1]["omega"]
    same([each["omega"] for each in fracfit.limit_cycles("1 + 0.3 s", **contact, band=(0.99 * last, 10)).cycles], [last])
    theirs = command_line.columns_of("basins", *words, "--omega", 1.35, "--position", "0.2,0.8", "--velocity=-1,0,1")
    starts = fracfit.basins(1.35, **contact, position=[0.2, 0.8], velocity=[-1, 0, 1])
    assert list(starts.attractor.ravel()) == [int(each) for each in theirs["attractor"]]
    asked = ["--clearance", 0.01, "--crossover", 2, "--structure", "pd", "--mu", 1, "--body", "x2"]
    theirs = command_line.json_of("tune", *asked, *words, "--phase-margin", 50)
    tuned = fracfit.tune(clearance=0.01, crossover=2, structure="pd", mu=1, body="x2", **contact, phase_margin=math.radians(50))
    np.testing.assert_allclose(tuned.motion["swing"], theirs["backlash"]["swing_m"], rtol=1e-6)  # degrees round otherwise
    with pytest.raises(ValueError, match="has no meaning with contact_stiffness"):
        fracfit.loop("1 + s", **contact, whole_memory=True)
    with pytest.raises(ValueError, match="branches has no meaning with contact_stiffness"):
        fracfit.limit_cycles("1 + s", **contact, branches=True)


def body(text):
    """Code without what is said of its origin."""
    # A guard is made from all of it.
    return re.sub(r"_H_[0-9a-f]+|MODEL_TOKEN .*", "", re.sub(r"/\*.*?\*/", "", text, flags=re.S))


@pytest.mark.bits
def test_exports(tmp_path):
    theirs = command_line.run("export", "spice", "s^-0.5", "--kind", "impedance", "--band", "1:1e4")
    ours = fracfit.export_spice("s^-0.5", kind="impedance", band=(1, 1e4), out=tmp_path / "half.lib")
    elements = [line for line in ours.netlist.splitlines() if line and line[0] in "RCL."]
    assert elements == [line for line in theirs.splitlines() if line and line[0] in "RCL."]
    assert (tmp_path / "half.lib").read_text() == ours.netlist
    warburg = fracfit.export_spice(Model("2 tanh(sqrt(T s))/sqrt(T s)", T=3), kind="impedance", band=(1e-2, 1e2))
    assert warburg.max_relative_error < 1e-3

    pid = FractionalPid(2, 3, lambda_=0.8, sample_time=1e-3, band=(0.1, 300), minimum=-5, maximum=5)
    words = ["--kp", 2, "--ki", 3, "--lambda", 0.8, "--sample-time", 1e-3, "--band", "0.1:300"]
    theirs = command_line.run("export", "c99", *words, "--min", -5, "--max", 5)
    assert body(fracfit.export_c99(pid)) == body(theirs) == body(pid.c_header())
    theirs = command_line.run("export", "c99", "--model", "1/(s^0.5 + 1)", "--sample-time", 0.01, "--fixed-point", "1:1")
    assert body(fracfit.export_c99("1/(s^0.5 + 1)", sample_time=0.01, fixed_point=(1, 1))) == body(theirs)

    files = fracfit.export_arduino(pid, tmp_path / "heater", name="heater")
    assert {file.name for file in files} >= {"library.properties", "keywords.txt"} and all(file.exists() for file in files)

    unit = fracfit.export_fmu(out=tmp_path / "gear.fmu", clearance=0.001, restitution=0.6, mass1=2, name="gear")
    command_line.run("export", "fmu", "--clearance", 0.001, "--restitution", 0.6, "--mass1", 2, "--name", "gear", "--out", tmp_path / "theirs.fmu")
    with zipfile.ZipFile(unit) as mine, zipfile.ZipFile(tmp_path / "theirs.fmu") as other:
        assert mine.namelist() == other.namelist() and "modelDescription.xml" in mine.namelist()
        for name in mine.namelist():
            if name.endswith((".c", ".h")):
                assert body(mine.read(name).decode()) == body(other.read(name).decode())
    assert zipfile.ZipFile(fracfit.export_fmu("1/(s^0.5 + 1)", tmp_path / "plant.fmu", band=(0.01, 10), tolerance=1e-2)).testzip() is None
    third = zipfile.ZipFile(fracfit.export_fmu(pid, tmp_path / "third.fmu", fmi=3))
    assert 'fmiVersion="3.0"' in third.read("modelDescription.xml").decode()
    for wrong, sentence in (
        ({"source": pid, "fmi": 1}, "fmi is 1; expected 2 or 3"),
        ({"source": "1/(s^0.5 + 1)"}, "band has no value"),
        ({}, "source has no value"),
        ({"clearance": 0.1}, "restitution has no value"),
        ({"clearance": 0.1, "restitution": 0.5, "band": (1, 2)}, "band has no meaning"),
        ({"source": pid, "band": (1, 2)}, "band has no meaning"),
    ):
        with pytest.raises(ValueError, match=sentence):
            fracfit.export_fmu(out=tmp_path / "no.fmu", **wrong)
    with pytest.raises(ValueError, match="sample_time has no value"):
        fracfit.export_c99("1/(s + 1)")


def test_a_report(tmp_path):
    pytest.importorskip("fracfit._report")
    step = os.path.join(EXAMPLES, "step.csv")
    index = fracfit.report(tmp_path / "report", step, threads=1)
    assert index.read_text().count("<h2") > 1 and (tmp_path / "report" / "results.json").exists()
    with pytest.raises(RuntimeError, match="missing.csv"):
        fracfit.report(tmp_path / "other", tmp_path / "missing.csv")


def test_bands_are_those_of_the_command_line(tmp_path):
    path = tmp_path / "fit.json"
    path.write_text(command_line.run("fit", CELL, "--model", "zarc", "--format", "json"))
    theirs = command_line.columns_of("evaluate", "--fit", path, "--omega", "1:100:5log")
    band = fracfit.fit(fracfit.read(CELL), "zarc").band(theirs["omega_rad_s"])
    for name, column in band._columns().items():
        np.testing.assert_allclose(column, theirs[name], rtol=1e-9)  # the file has the correlation in place of the covariance


def test_admittance_as_the_component(tmp_path):
    """By the command line and here the same numbers, of the inverse that the file's unit asks for."""
    path = tmp_path / "z.csv"
    s = 1j * np.logspace(-1, 2, 40)
    z = (s + 10) / (1.5 * s + 4) * (1 + 1e-3 * np.exp(1j * np.arange(40) ** 2))
    path.write_text("omega_rad_s,re_ohm,im_ohm\n" + "".join(f"{w!r},{v.real!r},{v.imag!r}\n" for w, v in zip(s.imag.tolist(), z.tolist())))
    data = fracfit.read(path)
    model = "(A s + B)/(s + p)"
    result = fracfit.fit(data, model, component="admittance")
    told = command_line.json_of("fit", str(path), "--model", model, "--component", "admittance")
    assert result.parameters == {p["name"]: p["value"] for p in told["parameters"]}
    assert result.data.unit == "S" and np.allclose(result.data.response, 1 / z, rtol=1e-15, atol=0)
    assert fracfit.fit(data.inverse(), model, component="admittance").parameters == result.parameters
    assert fracfit.batch([data], model, component="admittance").results[0].parameters == result.parameters
    assert fracfit.identify(data, ["gain", model], component="admittance").ranking[0]["fit"].data.unit == "S"
    joint = fracfit.joint_fit([data, data.inverse()], model, shared="A,B,p", component="impedance")
    assert np.isclose(joint["p"], 4 / 1.5, rtol=0.01)  # disturbed by 0.1 % at each of 80 points
    assert fracfit.validate(data, component="admittance").data.unit == "S"
    with pytest.warns(UserWarning, match="taken for the impedance"):
        fracfit.validate(fracfit.FrequencyResponse(data.omega, data.response), component="admittance")
    with pytest.raises(ValueError, match="in Pa, neither an impedance nor an admittance"):
        fracfit.fit(fracfit.FrequencyResponse(data.omega, data.response, unit="Pa"), model, component="admittance")
    with pytest.raises(ValueError, match="component is 'phase'"):
        fracfit.validate(data, component="phase")


def test_a_drive_with_a_cascade():
    words = {"inertia1": 0.2, "inertia2": 0.01, "gear_ratio": 5, "gap_degrees": 0.1, "torque_limit": 2.0, "load_torque": -0.05, "step_degrees": 1}
    options = [f"--{name.replace('_', '-')}={value}" for name, value in words.items()]
    theirs = command_line.columns_of(
        "loop", "--controller", "cascade(8, 0.9, 0.5)", "--body", "x2", *options, "--restitution", 0.3, "--duration", 0.2, "--every", 0.02
    )
    # At the shaft of the load the speed controller of motor torque and motor angle counts 25 times.
    ours = fracfit.loop("(8 + s) (25*0.9 + 25*0.9/(0.5 s))", setpoint_lag=1 / 8, body="x2", restitution=0.3, duration=0.2, every=0.02, **fracfit.drive(**words))
    assert len(ours.time) == len(theirs["time_s"]) > 20
    # Roundings of the gains, and what two dozen impacts make of them.
    np.testing.assert_allclose(ours.x2, theirs["x2_m"], atol=1e-10)
    np.testing.assert_allclose(ours.force, theirs["force_n"], atol=1e-6)
    scene = fracfit.drive(inertia1=0.2, inertia2=0.01, gear_ratio=5, gap_degrees=0.1, torque=2)
    n = fracfit.describing_function([300.0], restitution=0.3, **scene)
    told = command_line.columns_of("simulate", *options[:4], "--torque", 2, "--restitution", 0.3, "--omega", 300)
    assert n.response[0] == complex(told["re_m_per_n"][0], told["im_m_per_n"][0])
