"""Joints, the FES controller and the prosthesis."""

import math
import tomllib

import numpy as np
import pytest
from conftest import PAPER

import vm_nostd as vm

MODEL = ["f32", "fixed", "f64"]


@pytest.mark.parametrize("arithmetic", MODEL)
def test_the_ankle_is_that_of_the_library_s_example(arithmetic):
    ankle = vm.Joint.named("ankle", arithmetic=arithmetic)
    posture = ankle.posture([0.0])
    assert posture.status == vm.JointStatus(0)
    tibialis, soleus = ankle.muscles
    (torque,) = ankle.torques_nm([0.0], [0.5 * tibialis.max_isometric_force_n, 0.0])
    assert 15 < torque < 20
    flexes, extends = posture.moment_arms_m[:, 0]
    assert torque == pytest.approx(0.5 * 905 * flexes, rel=1e-4) and extends < 0
    assert ankle.posture([3.0]).status == vm.JointStatus.ANGLE_CLIPPED
    for muscle, path in zip(ankle.muscles, posture.path_lengths_m):
        assert muscle.path_domain_m[0] < path < muscle.path_domain_m[1]


def test_a_joint_of_one_s_own():
    muscle = vm.Muscle("soleus")
    path_m = muscle.fascicle_length_m + muscle.tendon_length_m
    path = vm.JointPath(path_m, [0.1], [[-0.03, 0.01]], ["flexes"])
    joint = vm.Joint([(-0.3, 0.3)], [muscle], [path])
    posture = joint.posture([0.2])
    assert posture.path_lengths_m[0] == pytest.approx(path_m - 0.03 * 0.1 + 0.01 * 0.01, rel=1e-6)
    assert posture.moment_arms_m[0, 0] == pytest.approx(0.03 - 0.02 * 0.1, rel=1e-5)
    two = vm.JointPath(path_m, [0, 0], [[-0.03], [0.02]], ["flexes", "extends"], 0.01)
    joint = vm.Joint([(-0.2, 0.2)] * 2, [muscle, muscle], [two, two])
    np.testing.assert_allclose(
        joint.posture([0.1, -0.1]).moment_arms_m[1], [0.03 + 0.001, -0.02 - 0.001], rtol=1e-4
    )
    assert joint.torques_nm([0, 0], [100, 0])[1] == pytest.approx(-2, rel=1e-4)
    refusals = [
        (lambda: vm.Joint([(-0.3, 0.3)], [muscle], []), "paths = 0 paths: must be 1"),
        (lambda: vm.Joint([(-0.3, 0.3)], [muscle], [two]), "reference_rad = 2 joints: must be 1"),
        (lambda: vm.JointPath(1, [0], [[0] * 7], ["flexes"]), "7 terms: must be at most 6"),
        (lambda: vm.JointPath(1, [0], [[0]], ["bends"]), "action = bends: must be flexes"),
        (lambda: joint.posture([0.1]), "1 angles: must be 2"),
        (lambda: joint.torques_nm([0, math.nan], [0, 0]), "angles_rad = nan: must be finite"),
        (lambda: joint.torques_nm([0, 0], [1]), "1 numbers: must be 2"),
        (lambda: vm.Joint.named("hip"), "name = hip: must be ankle, knee or elbow"),
        (
            lambda: vm.Joint(
                [(-0.3, 0.3)], [muscle], [vm.JointPath(path_m, [0], [[0.03]], ["flexes"])]
            ),
            r"muscles\[0\]\.path\.terms_m_per_rad: moment arm of a flexor, m",
        ),
    ]
    for refused, message in refusals:
        with pytest.raises(vm.ParameterError, match=message):
            refused()


@pytest.mark.parametrize("arithmetic", MODEL)
@pytest.mark.parametrize("mode", ["fes", "continuous"])
def test_the_stiffness_of_a_joint_is_the_slope_of_its_torque(arithmetic, mode):
    knee = vm.Joint.named("knee", mode=mode, arithmetic=arithmetic)
    activations = [0.3, 0.2]

    def held(angle):
        """Forces (N) and stiffnesses (N/m) of the muscles that are held there."""
        states = [m.at_rest(p) for m, p in zip(knee.muscles, knee.posture([angle]).path_lengths_m)]
        ticks = np.ones(4000)
        for state, path, u in zip(states, knee.posture([angle]).path_lengths_m, activations):
            state.run(u * ticks, path, 40)
        return [s.output.force_n for s in states], [s.stiffness_n_per_m() for s in states]

    angle, step = 0.5, 0.02
    forces, stiffnesses = held(angle)
    (stiffness,) = knee.stiffnesses_nm_per_rad([angle], forces, stiffnesses)
    ends = [angle - step, angle + step]
    less, more = [knee.torques_nm([end], held(end)[0])[0] for end in ends]
    # What comes back is against the motion.
    assert stiffness == pytest.approx((less - more) / (2 * step), rel=5e-3)
    assert abs(stiffness) > 1
    # Muscles that pull without stiffness: the moment arms' slopes.
    arms = [knee.posture([end]).moment_arms_m[:, 0] for end in ends]
    slopes = (arms[1] - arms[0]) / (2 * step)
    (geometric,) = knee.stiffnesses_nm_per_rad([angle], forces, [0, 0])
    assert geometric == pytest.approx(-float(slopes @ forces), rel=0.02, abs=0.02)


def test_stiffness_is_refused_where_there_is_none(paper):
    knee = vm.Joint.named("knee")
    for refuse, message in [
        (lambda: knee.stiffnesses_nm_per_rad([0.8], [1, 1], [1]), "_m = 1 numbers: must be 2"),
        (lambda: knee.stiffnesses_nm_per_rad([0.8], [1, 1], [1, math.nan]), "nan: must be fin"),
        (lambda: paper.replace(arithmetic="reference").at_rest(0.16).stiffness_n_per_m(),
         "arithmetic = reference: must be f32"),
    ]:  # fmt: skip
        with pytest.raises(vm.ParameterError, match=message):
            refuse()
    units = tomllib.loads(PAPER.read_text())
    units["fiber"] = [fiber | {"units": 3} for fiber in units["fiber"]]
    with pytest.raises(vm.ParameterError, match="mode = discrete: must be continuous or fes"):
        vm.Muscle(units, mode="discrete").at_rest(0.16).stiffness_n_per_m()


def test_fatigue_takes_from_the_stiffness_what_it_takes_from_the_force():
    text = PAPER.read_text()
    tired = text + "[fatigue]\nT_fat_s = 2\nT_rec_s = 30\nfit_min = 0\nbeta = 0.6\n"
    of_both = []
    for muscle in [text, tired]:
        state = vm.Muscle.from_toml(muscle, mode="fes").at_rest(0.16)
        state.run(np.ones(2000), 0.16, 30)
        of_both.append(np.array([state.output.force_n, state.stiffness_n_per_m()]))
    shares = of_both[1] / of_both[0]
    assert shares[0] < 0.8 and shares[1] == pytest.approx(shares[0], rel=1e-6)


def controller(joint, **changes):
    curve = vm.RecruitmentCurve(6, 18, 200, 2)
    parameters = {
        "pulse_amplitude_ma": 30,
        "inertia_kg_m2": 0.46,
        "damping_nm_s_per_rad": 0.8,
        "gravity_nm": 11.7,
        "hanging_angle_rad": 1.57,
        "proportional_nm_per_rad": 15,
        "integral_nm_per_rad_s": 8,
        "derivative_nm_s_per_rad": 3,
    }
    return vm.FesController(joint, (curve, curve), **(parameters | changes))


@pytest.mark.parametrize("arithmetic", MODEL)
def test_the_controller_extends_the_knee(arithmetic):
    """The example of vm-nostd/README.md: the knee is extended by 40 degrees."""
    knee = vm.Joint.named("knee", arithmetic=arithmetic)
    control = controller(knee, arithmetic=arithmetic)
    control.start(1.4)
    angle, velocity = 1.4, 0.0
    paths = knee.posture([angle]).path_lengths_m
    states = [muscle.at_rest(path) for muscle, path in zip(knee.muscles, paths)]
    words = None
    for tick in range(4000):
        command = control.step(0.7, angle)
        paths = knee.posture([angle]).path_lengths_m
        forces = [
            state.step(activation, path, 40).force_n
            for state, activation, path in zip(states, command.activations, paths)
        ]
        (torque,) = knee.torques_nm([angle], forces)
        velocity += 1e-3 / 0.46 * (torque - 0.8 * velocity - 11.7 * math.sin(angle - 1.57))
        angle += 1e-3 * velocity
        if tick == 2000:
            words = control.save()
    assert angle == pytest.approx(0.7, abs=0.02)
    assert command.amplitudes_ma == (30, 30) and 0 < command.widths_us[1] < 5000
    restored = controller(knee, arithmetic=arithmetic)
    restored.restore(words)
    control.restore(words)
    assert restored.step(0.7, 0.8) == control.step(0.7, 0.8)
    other = controller(knee, arithmetic=arithmetic, gravity_nm=11)
    with pytest.raises(vm.ParameterError, match="words = "):
        other.restore(words)


def test_controllers_are_refused_with_field_value_and_limit():
    knee = vm.Joint.named("knee")
    for changes, message in [
        ({"gravity_nm": -1}, "gravity_nm = -1: must be between 0 and 200"),
        ({"pulse_width_us": 300}, "= both: give the one that is constant"),
        ({"pulse_amplitude_ma": 300}, r"\]\.pulse_amplitude_ma = 300: must be between 0.1 and 200"),
        ({"torque_range_nm": (5, 6)}, r"torque_range_nm\[0\] = 5: must be between -1000 and 0"),
        ({"expected_lag_s": 0}, "expected_lag_s = 0: must be between 0.001 and 1"),
        ({"measured": "force"}, "measured = force: must be angle or torque"),
        ({"time_step_s": 1}, "time_step_s = 1: must be between"),
        ({"gain": vm.GainEstimate(0, 0.5, 2, 1)}, "gain.time_s = 0: must be between 0.1"),
    ]:
        with pytest.raises(vm.ParameterError, match=message):
            controller(knee, **changes)
    with pytest.raises(vm.ParameterError, match="measured_rad = nan: must be finite"):
        controller(knee).step(0.7, math.nan)
    tired = vm.FatigueParams(18, 30, 0.1, 0.6)
    tiring = controller(knee, fatigue=(tired, tired), gain=vm.GainEstimate(10, 0.3, 3, 1))
    assert tiring.step(0.7, 0.7).gain == pytest.approx(1, abs=2e-4)


@pytest.mark.parametrize("arithmetic", MODEL)
def test_a_prosthesis_moves_with_its_emg(arithmetic):
    knee = vm.Joint.named("knee", mode="continuous", arithmetic=arithmetic)
    envelope = vm.Envelope(0.01, 1.0, 4.0, 0.02, -1.0)
    limits = {"torque_limits": (-80.0, 80.0, 1000.0), "stiffness_limits": (0.0, 300.0, 3000.0)}

    def prosthesis(**changes):
        return vm.Prosthesis(
            knee, (envelope, envelope), 0.58, arithmetic=arithmetic, **(limits | changes)
        )

    flexing, both = prosthesis(), prosthesis()
    for _ in range(1000):
        flexed = flexing.step((0.8, 0.0), 0.58)
        stiff = both.step((0.8, 0.8), 0.58)
    assert flexed.torque_nm > 5 and flexed.activations[0] > 0.5 > flexed.activations[1]
    assert stiff.torque_nm < flexed.torque_nm
    assert stiff.stiffness_nm_per_rad > flexed.stiffness_nm_per_rad > 0
    words = both.save()
    restored = prosthesis()
    restored.restore(words)
    assert restored.step((0.1, 0.2), 0.6) == both.step((0.1, 0.2), 0.6)
    with pytest.raises(vm.ParameterError, match="words = "):
        prosthesis(torque_limits=(-80.0, 81.0, 1000.0)).restore(words)
    with pytest.raises(vm.ParameterError, match=r"emg_mv\[1\] = nan"):
        both.step((0.1, math.nan), 0.6)
