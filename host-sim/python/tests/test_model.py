"""Curves, inverse, fatigue, recruitment curve, saved states and threads."""

import copy
import pickle
import signal
import subprocess
import sys
import threading
import time
import tomllib

import numpy as np
import pytest
from conftest import DATA, PAPER

import vm_nostd as vm
from vm_nostd import _native

MODEL = ["f32", "fixed", "f64"]


def test_flags_are_those_of_rust():
    flags = _native.flags()
    assert len(flags) == 5
    for name, bits in flags.items():
        assert [(flag.name, int(flag)) for flag in getattr(vm, name)] == bits


def test_everything_exported_is_documented():
    for name in vm.__all__:
        exported = getattr(vm, name)
        assert exported.__doc__, name
        if exported.__module__ == "vm_nostd":
            for method in vars(exported):
                assert method.startswith("_") or getattr(exported, method).__doc__, (name, method)


@pytest.mark.parametrize("mode", ["continuous", "fes"])
@pytest.mark.parametrize("arithmetic", MODEL)
def test_a_restored_state_goes_on_with_the_same_bits(mode, arithmetic):
    text = PAPER.read_text() + "[fatigue]\nT_fat_s = 2\nT_rec_s = 30\nfit_min = 0\nbeta = 0.6\n"
    muscle = vm.Muscle.from_toml(text, mode=mode, arithmetic=arithmetic)
    whole = muscle.run(np.ones(401), 0.16, 30)
    state = muscle.at_rest(0.16)
    first = state.run(np.ones(200), 0.16, 30)
    words, copied = state.save(), state.copy()
    rest = state.run(np.ones(200), 0.16, 30)
    for column in range(4):
        np.testing.assert_array_equal(np.append(first[column], rest[column]), whole[column][1:])
    restored = muscle.at_rest(0.15)
    restored.restore(words)
    for other in [restored, copied]:
        np.testing.assert_array_equal(other.save(), words)
        for found, wanted in zip(other.run(np.ones(200), 0.16, 30), rest, strict=True):
            np.testing.assert_array_equal(found, wanted)
    stepped = copied.step(0.5, 0.16, 30)
    assert stepped[:3] == copied.output[:3]


def test_other_words_are_refused_and_leave_the_state(paper):
    state = paper.at_rest(0.16)
    before = state.save()
    other = paper.replace(mode="continuous").at_rest(0.16).save()
    flipped = before.copy()
    flipped[3] ^= np.uint64(1 << 30)
    for words in [other, before[:-1], np.append(before, before[:1]), flipped, before + (1 << 40)]:
        with pytest.raises(vm.ParameterError, match="words = "):
            state.restore(np.asarray(words, np.uint64))
        np.testing.assert_array_equal(state.save(), before)
    with pytest.raises(vm.ParameterError, match="copy it instead"):
        paper.replace(arithmetic="reference").at_rest(0.16).save()


def test_the_reference_is_copied(paper):
    state = paper.replace(arithmetic="reference").at_rest(0.16)
    state.run(np.ones(20), 0.16, 30)
    copied = state.copy()
    assert copied.step(1, 0.16, 30) == state.step(1, 0.16, 30)
    copied.step(1, 0.16, 30)
    assert copied.output != state.output


@pytest.mark.parametrize("arithmetic", ["f32", "reference"])
def test_muscles_and_states_are_copied_and_pickled(paper, arithmetic):
    muscle = paper.replace(arithmetic=arithmetic, accuracy_class="fine", time_step_s=5e-4)
    force = muscle.run(np.ones(20), 0.16, 30).force_n
    for same in [copy.copy(muscle), copy.deepcopy(muscle), pickle.loads(pickle.dumps(muscle))]:
        assert repr(same) == repr(muscle)
        np.testing.assert_array_equal(same.run(np.ones(20), 0.16, 30).force_n, force)
    state = muscle.at_rest(0.16)
    for other in [copy.copy(state), copy.deepcopy(state)]:
        other.step(1, 0.16, 30)
        assert other.output != state.output


def test_a_file_has_the_accuracy_class(paper):
    assert "class" not in paper.to_toml()
    fine = vm.Muscle.from_toml(paper.replace(accuracy_class="fine").to_toml(), mode="fes")
    assert fine.accuracy_class == "fine"


# In a process of its own, to which Ctrl-C comes while it works.
INTERRUPTED = """
import sys, time
import numpy as np
import vm_nostd as vm
path = sys.argv[1]
paper = vm.Muscle(path, mode="fes", arithmetic="f64")
WORK = {
    "run": lambda: paper.run(np.broadcast_to(1.0, 8_000_000), 0.16, 30),
    "steady": lambda: paper.steady().activation_for(np.broadcast_to(50.0, 8_000_000), 0.16, 30),
    "fatigue": lambda: tired.run(np.broadcast_to(1.0, 30_000_000)),
    "fit": lambda: vm.fit(
        paper,
        {
            "noise_pct_f0": 1,
            "trial": [{
                "name": "tetanus", "role": "fit", "mode": "fes",
                "force": {"time_s": np.arange(60_000) * 1e-3,
                          "value": 50 + np.sin(np.arange(60_000))},
                "length": {"constant": 0.16}, "activation": {"constant": 0.5},
                "stimulation_pps": {"constant": 40},
            }],
            "free": [{"name": "max_isometric_force_n", "bounds": [100, 600]}],
        },
        starts=1000,
    ),
}
tired = vm.Fatigue.quadriceps(arithmetic="fixed")
print("works", flush=True)
try:
    WORK[sys.argv[2]]()
except KeyboardInterrupt:
    assert tired.fitness == 1
    print("interrupted")
"""


@pytest.mark.parametrize("work", ["run", "steady", "fatigue", "fit"])
def test_long_work_is_interrupted(work):
    command = [sys.executable, "-c", INTERRUPTED, str(PAPER), work]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline() == "works\n"
            time.sleep(0.3)
            process.send_signal(signal.SIGINT)
            # None of it ends in so short a time by itself.
            assert process.communicate(timeout=8)[0] == "interrupted\n"
        finally:
            process.kill()


def test_a_run_releases_the_lock(paper):
    muscle = paper.replace(arithmetic="f64", accuracy_class="fine")
    activation = np.ones(300_000)
    running = threading.Thread(target=lambda: muscle.run(activation, 0.16, 30))
    running.start()
    turns = 0
    while running.is_alive():
        turns += 1
        time.sleep(1e-3)
    # With the lock held this thread would have had a turn or two.
    assert turns > 10


@pytest.mark.parametrize("arithmetic", MODEL)
def test_curves_are_the_paper_s(arithmetic):
    muscle = vm.Muscle(PAPER, arithmetic=arithmetic)
    curves = muscle.curves()
    length, velocity = np.linspace(0.7, 1.3, 61), np.linspace(-4, 4, 61)
    slow, fast = 0, 1
    near = {"rtol": 0, "atol": 1e-5}
    # Table 1 of the paper.
    expected = np.exp(-(np.abs((length**2.30 - 1) / 1.12) ** 1.62))
    np.testing.assert_allclose(curves.force_length(slow, length), expected, **near)
    shortening = (-7.88 - velocity) / (-7.88 + 5.88 * velocity)
    lengthening = (0.35 - (-4.70 + 8.41 - 5.34) * velocity) / (0.35 + velocity)
    expected = np.where(velocity <= 0, shortening, lengthening)
    np.testing.assert_allclose(curves.force_velocity(slow, 1, velocity), expected, **near)
    n_f = 2.1 + 3.3 * (1 / length - 1)
    expected = 1 - np.exp(-((0.8 / (0.56 * n_f)) ** n_f))
    np.testing.assert_allclose(curves.activation_frequency(fast, length, 0.8), expected, **near)
    assert curves.force_velocity(fast, 1.0, 0.0) == 1
    assert curves.passive(0.8) < 1e-3 < curves.passive(1.4)
    assert curves.compression(0.6) < -0.01 and curves.compression(1.0) == 0
    path = muscle.fascicle_length_m + muscle.tendon_length_m
    assert curves.tendon(1.0, path) == pytest.approx(1, abs=0.01)
    with pytest.raises(vm.ParameterError, match="fiber = 2: must be 0 to 1"):
        curves.force_length(2, 1.0)
    with pytest.raises(vm.ParameterError, match="arithmetic = reference: must be f32"):
        muscle.replace(arithmetic="reference").curves()


@pytest.mark.parametrize("arithmetic", MODEL)
@pytest.mark.parametrize("mode", ["continuous", "fes"])
def test_the_inverse_holds_the_force(mode, arithmetic):
    muscle = vm.Muscle(PAPER, mode=mode, arithmetic=arithmetic)
    steady = muscle.steady()
    forces = np.array([20.0, 60.0, 100.0])
    activations, flags = steady.activation_for(forces, 0.16, 30)
    assert not flags.any() and (np.diff(activations) > 0).all()
    for force, activation in zip(forces, activations):
        held = muscle.run(np.full(3000, activation), 0.16, 30).force_n[-1]
        assert held == pytest.approx(force, abs=2e-3 * muscle.max_isometric_force_n)
    unreachable, flag = steady.activation_for(500.0, 0.16, 30)
    assert (unreachable, flag) == (1, vm.Status.FORCE_UNREACHABLE)
    if mode == "fes":
        found, flags = steady.force(activations, 0.16, 30)
        np.testing.assert_allclose(found, forces, atol=0.3)
        with pytest.raises(vm.ParameterError, match="stimulation_frequency_pps = None"):
            steady.activation_for(60.0, 0.16)
    with pytest.raises(vm.ParameterError, match="mode = discrete"):
        hand = tomllib.loads(PAPER.read_text())
        hand["fiber"] = [fiber | {"units": 3} for fiber in hand["fiber"]]
        vm.Muscle(hand, mode="discrete").steady()


@pytest.mark.parametrize("arithmetic", MODEL)
def test_fatigue_is_that_of_the_library_s_example(arithmetic):
    fatigue = vm.Fatigue.quadriceps(arithmetic=arithmetic)
    tired = fatigue.run(np.ones(30_000), 20)
    assert tired[-1] == pytest.approx(0.602, abs=1e-3) == fatigue.fitness
    words = fatigue.save()
    assert fatigue.run(np.zeros(30_000), 20)[-1] == pytest.approx(0.854, abs=1e-3)
    fatigue.restore(words)
    assert fatigue.fitness == tired[-1]
    assert fatigue.advance(1) < tired[-1]
    fatigue.rest()
    assert fatigue.fitness == 1
    with pytest.raises(vm.ParameterError, match="words = "):
        vm.Fatigue(18, 30, 0.1, 0.6, arithmetic=arithmetic).restore(words)
    with pytest.raises(vm.ParameterError, match="recovery_time_s = 0: must be between 1 and 1000"):
        vm.Fatigue(18, 0, 0.1, 0.6)


@pytest.mark.parametrize("arithmetic", MODEL)
def test_a_recruitment_curve_and_its_inverses(arithmetic):
    curve = vm.RecruitmentCurve(4, 12, 200, 2, arithmetic=arithmetic)
    assert curve.activation(16, 200)[0] == pytest.approx(0.5, abs=1e-6)
    wanted = np.linspace(0.1, 0.9, 9)
    amplitudes, flags = curve.amplitude_for(wanted, 300)
    assert not flags.any()
    np.testing.assert_allclose(curve.activation(amplitudes, 300)[0], wanted, atol=1e-4)
    widths, flags = curve.width_for(wanted, 20)
    assert not flags.any()
    np.testing.assert_allclose(curve.activation(20, widths)[0], wanted, atol=1e-4)
    assert curve.amplitude_for(0.5, 0)[1] == vm.PulseStatus.UNREACHABLE
    with pytest.raises(vm.ParameterError, match="saturation_ma = 4: must be between 4.2 and 200"):
        vm.RecruitmentCurve(4, 4, 200, 2)
    of_file = vm.Muscle(DATA / "recovery_muscle.toml").recruitment_curve
    assert of_file.activation(16, 200)[0] == pytest.approx(0.5, abs=1e-6)
    assert vm.Muscle("soleus").recruitment_curve is None
