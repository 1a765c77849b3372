# SPDX-License-Identifier: BSD-3-Clause
"""Describing functions, maps, orbits and limit cycles against the command line and laws of similarity."""

import pickle
import threading

import command_line
import numpy as np
import pytest

import fracfit

SCENE = {"restitution": 0.6, "force": 40.0, "clearance": 0.3}
OPTIONS = ("--restitution", 0.6, "--force", 40, "--clearance", 0.3)


@pytest.mark.parametrize("protocol", ["sweep-up", "sweep-down", "contact-at-rest"])
def test_bits_of_simulate(protocol):
    omega = [8.0, 12.0, 17.0, 21.0, 30.0]
    found = command_line.columns_of("simulate", *OPTIONS, "--omega", ",".join(map(repr, omega)), "--protocol", protocol)
    curve = fracfit.describing_function(omega, protocol=protocol, **SCENE)
    assert found["re_m_per_n"] == curve.response.real.tolist()
    assert found["im_m_per_n"] == curve.response.imag.tolist()
    assert found["uncertainty_m_per_n"] == curve.uncertainty.tolist()
    assert found["regime"] == curve.regime.tolist()
    assert found["period"] == curve.period.tolist()


CONTACT = {"contact_stiffness": 2e4, "contact_damping": 50.0, "friction1": 2.0}


def test_bits_of_simulate_with_contacts_that_take_time():
    found = command_line.columns_of(
        "simulate", "--force", 40, "--clearance", 0.3, "--contact-stiffness", 2e4, "--contact-damping", 50,
        "--friction1", 2, "--omega", "12,20,30", "--protocol", "contact-at-rest",
    )
    curve = fracfit.describing_function([12.0, 20.0, 30.0], force=40, clearance=0.3, protocol="contact-at-rest", **CONTACT)
    assert found["re_m_per_n"] == curve.response.real.tolist()
    assert found["im_m_per_n"] == curve.response.imag.tolist()
    assert found["regime"] == curve.regime.tolist()


def test_contacts_have_a_restitution_or_take_time():
    with pytest.raises(ValueError, match="either restitution or contact_stiffness"):
        fracfit.describing_function([20.0], **SCENE, **CONTACT)
    with pytest.raises(ValueError, match="either restitution or contact_stiffness"):
        fracfit.describing_function([20.0])
    with pytest.raises(ValueError, match="contact_stiffness needs contact_damping"):
        fracfit.describing_function([20.0], contact_stiffness=1.0)
    with pytest.raises(ValueError, match="friction1 has no meaning with restitution"):
        fracfit.describing_function([20.0], friction1=1.0, **SCENE)
    contact = fracfit.contact_of_frequency(300.0, restitution=0.4, mass1=2.0)
    free = fracfit.free_contact(stiffness=contact["contact_stiffness"], damping=contact["contact_damping"], mass1=2.0)
    assert free["frequency"] == pytest.approx(300, rel=1e-15)
    assert free["restitution"] == pytest.approx(0.4, rel=1e-14)


def test_bits_of_the_static_model():
    found = command_line.columns_of("simulate", "--motion", "static", "--force", 40, "--clearance", 0.3, "--omega", "5,9,20")
    curve = fracfit.static_describing_function([5.0, 9.0, 20.0], force=40, clearance=0.3)
    assert found["re_m_per_n"] == curve.response.real.tolist()
    assert found["im_m_per_n"] == curve.response.imag.tolist()


def test_bits_of_map():
    found = command_line.columns_of("map", "--restitution", "0.2,0.8", "--omega", "1,2,3")
    table = fracfit.regime_map([1.0, 2.0, 3.0], [0.2, 0.8])
    assert table.response.shape == (2, 3)
    assert found["re_m_per_n"] == table.response.real.ravel().tolist()
    assert found["regime"] == table.regime.ravel().tolist()


def test_bits_of_map_with_contacts_that_take_time():
    found = command_line.columns_of(
        "map", "--contact-stiffness", "50,200", "--contact-damping", 1, "--friction1", 0.05, "--omega", "1.5,2,3",
    )  # fmt: skip
    table = fracfit.regime_map([1.5, 2.0, 3.0], contact_stiffness=[50.0, 200.0], contact_damping=1.0, friction1=0.05)
    assert table.response.shape == (2, 3)
    assert found["re_m_per_n"] == table.response.real.ravel().tolist()
    assert found["regime"] == table.regime.ravel().tolist()
    assert table.restitution[1] == fracfit.free_contact(stiffness=200.0, damping=1.0)["restitution"]
    with pytest.raises(ValueError, match="either restitution or contact_stiffness"):
        fracfit.regime_map([2.0])
    with pytest.raises(ValueError, match="friction1 has no meaning"):
        fracfit.regime_map([2.0], [0.5], friction1=1.0)
    with pytest.raises(ValueError, match="contact_stiffness needs contact_damping"):
        fracfit.regime_map([2.0], contact_stiffness=[1.0])


def test_families_broadcast_and_scale():
    omega = np.array([12.0, 20.0])
    force = np.array([[10.0], [40.0]])
    family = fracfit.describing_function(omega, restitution=[0.5, 0.6, 0.7], force=force, clearance=0.3)
    assert family.response.shape == (2, 3, 2)
    one = fracfit.describing_function(omega, **SCENE)
    assert np.array_equal(family.response[1, 1], one.response)
    # Similarity: four times the force at twice the frequency is the same motion four times slower in N omega^2.
    twice = fracfit.describing_function(2 * omega, restitution=0.6, force=160.0, clearance=0.3)
    assert np.array_equal(4 * twice.response, one.response)


def test_threads_make_no_difference_and_may_run_side_by_side():
    omega = np.linspace(8, 30, 40)
    results = [None] * 4

    def work(i):
        results[i] = fracfit.describing_function(omega, threads=i % 2 + 1, protocol="contact-at-rest", **SCENE)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(result == results[0] for result in results)


def test_progress_is_told():
    told = []
    fracfit.describing_function(np.linspace(8, 30, 200), progress=lambda done, total: told.append((done, total)), **SCENE)
    assert told[-1] == (200, 200)
    assert all(total == 200 for _, total in told)
    with pytest.raises(ZeroDivisionError):
        fracfit.describing_function(np.linspace(8, 30, 200), progress=lambda done, total: 1 / 0, **SCENE)
    with pytest.raises(ValueError, match="progress"):
        fracfit.describing_function([1.0], restitution=0.5, progress=3)


def test_orbits_and_cycles_of_the_command_line():
    found = command_line.json_of("orbits", "--restitution", 0.6, "--from", 1.9, "--to", 2.2)
    branches = fracfit.orbits(1.9, 2.2, restitution=0.6)
    assert len(found["branches"]) == len(branches)
    for theirs, ours in zip(found["branches"], branches):
        assert theirs["impacts_per_period"] * theirs["period"] == ours.impacts
        assert [orbit["omega_rad_s"] for orbit in theirs["orbits"]] == ours.parameter.tolist()
        assert [orbit["im_m_per_n"] for orbit in theirs["orbits"]] == ours.response.imag.tolist()

    found = command_line.json_of("limit-cycles", "--controller", "1 + s^0.5", "--restitution", 0.6)
    cycles = fracfit.limit_cycles("1 + s^0.5", restitution=0.6)
    assert str(cycles.cycles[0]["omega"]) in str(found)
    assert cycles.cycles[0]["stable"] and cycles.certain


def test_orbits_of_contacts_that_take_time():
    contact = fracfit.contact_of_frequency(20, restitution=0.6)
    branch = fracfit.orbits(1.5, 1.6, longest_period=1, most_impacts=2, **contact)[0]
    kinds = {each["kind"]: each["parameter"] for each in branch.bifurcations}
    # c of fracfit jump-law --constants, from the closed form of the symmetric orbit.
    assert branch.symmetric and abs(kinds["symmetry-breaking"] - 1.5382764311066555) < 1e-8
    with pytest.raises(ValueError, match="contact-frequency"):
        fracfit.orbits(0.3, 0.6, parameter="restitution", omega=2, **contact)


def test_cycles_of_bodies_and_of_more_impacts():
    # Motions that end in cycles with four impacts, which the equations of two impacts do not know.
    found = command_line.json_of("limit-cycles", "--controller", "20 + s", "--restitution", 0.6)
    ours = fracfit.limit_cycles("20 + s", restitution=0.6)
    kept = lambda cycles: sorted((each["omega"], each["impacts_per_period"], each["stable"]) for each in cycles)
    assert kept(ours.cycles) == kept(found["cycles"])
    assert max(each["impacts_per_period"] for each in ours.cycles) > 2
    assert ours.motions == [each["regime"] for each in found["motions"]]
    assert "4 impacts" in repr(ours)
    assert all(each["impacts_per_period"] == 2 for each in fracfit.limit_cycles("20 + s", restitution=0.6, starts=0).cycles)

    found = command_line.json_of(
        "limit-cycles", "--controller", "2 + s", "--load-receptance", "1/(s^2 + 0.2 s)", "--restitution", 0.6, "--starts", 0
    )
    damped = fracfit.limit_cycles("2 + s", load_receptance="1/(s^2 + 0.2 s)", restitution=0.6, starts=0)
    assert kept(damped.cycles) == kept(found["cycles"])
    with pytest.raises(ValueError, match="mass1 does not go with load_receptance"):
        fracfit.limit_cycles("2 + s", load_receptance="1/s^2", mass1=2, restitution=0.6)
    with pytest.raises(ValueError, match="starts is 1.5"):
        fracfit.limit_cycles("2 + s", restitution=0.6, starts=1.5)


def test_jump_from_contact_at_rest():
    # w_L = sqrt(2 F/(clearance M2)), eq. (6) of Duarte, Tenreiro Machado (2009).
    jump = fracfit.jump_frequency(restitution=0.3, force=40, clearance=0.3, mass2=2, criterion="contact-at-rest")
    assert jump == pytest.approx(np.sqrt(2 * 40 / (0.3 * 2)), rel=1e-14)


def test_results_pickle_and_print():
    for result in (
        fracfit.describing_function([12.0, 20.0], **SCENE),
        fracfit.regime_map([1.0, 2.0], [0.5]),
        fracfit.orbits(1.9, 2.2, restitution=0.6)[0],
        fracfit.limit_cycles("1 + s^0.5", restitution=0.6),
    ):
        again = pickle.loads(pickle.dumps(result))
        assert repr(again) == repr(result)
        assert again == result
        assert "<table>" in result._repr_html_()


def test_wrong_scenes_are_refused():
    with pytest.raises(ValueError, match="restitution"):
        fracfit.describing_function([1.0], restitution=1.5)
    with pytest.raises(ValueError, match="omega"):
        fracfit.describing_function([2.0, 1.0], restitution=0.5)
    with pytest.raises(ValueError, match="protocol"):
        fracfit.describing_function([1.0], restitution=0.5, protocol="fast")
    with pytest.raises(ValueError, match="give either restitution"):
        fracfit.orbits(1.0, 2.0)
    with pytest.raises(ValueError):
        fracfit.describing_function([1.0], restitution=[0.1, 0.2], force=[1.0, 2.0, 3.0])


def test_minus_inverse_is_that_of_simulate(tmp_path):
    omega = [8.0, 17.0, 25.0, 30.0]
    grid = ("--omega", ",".join(map(repr, omega)), "--quantity", "minus-inverse")
    found = command_line.columns_of("simulate", *OPTIONS, *grid)
    curve = fracfit.describing_function(omega, **SCENE)
    assert found["re_n_per_m"] == curve.minus_inverse.real.tolist()
    assert found["im_n_per_m"] == curve.minus_inverse.imag.tolist()
    # The law of two symmetric impacts per period, with M1 + M2 = 2 kg; values are rounded a few times.
    assert curve.regime[2:].tolist() == ["symmetric", "symmetric"]
    loss = curve.minus_inverse.imag[2:] / (2 * curve.omega[2:] ** 2)
    np.testing.assert_allclose(loss, fracfit.symmetric_loss_factor(0.6), rtol=1e-12)
    assert fracfit.restitution_from_loss_factor(loss[0]) == pytest.approx(0.6, abs=1e-12)
    assert fracfit.restitution_from_loss_factor(1.0) is None
    # A file of N is read as -1/N.
    path = tmp_path / "curve.csv"
    path.write_text("omega_rad_s,re_m_per_n,im_m_per_n\n1,-0.5,0\n2,0,0\n4,0,0.25\n")
    read = fracfit.read(path, quantity="minus-inverse")
    assert read.response.tolist() == [2, 4j]
    assert read.unit == "N/m"
    assert "2 rad/s" in read.metadata["notes"]
    again = fracfit.read(path).minus_inverse()
    assert again.response.tolist() == read.response.tolist()
    assert again.unit == "N/m"
    assert again.minus_inverse().unit == "m/N"
