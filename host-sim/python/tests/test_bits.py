"""Every output has the bits of `vm run`, and every state those of the golden checksums."""

import tomllib

import numpy as np
import pytest
from conftest import DATA, MODES, PAPER, bits, vector

import vm_nostd as vm

UNITS = """
name = "hand"
mass_g = 4
fascicle_length_cm = 3.2
tendon_length_cm = 6
max_path_length_cm = 10.6
recruitment_saturation = 0.6
coefficients = "human-vm4"
class = "economy"
fiber = [
  { preset = "human-vm4/super-slow", fraction = 0.2, units = 3 },
  { preset = "human-vm4/slow", fraction = 0.45, units = 5, unit_sizes = "equal" },
  { preset = "human-vm4/fast", fraction = 0.35, units = 7 },
]
fatigue = { T_fat_s = 2, T_rec_s = 30, fit_min = 0.1, beta = 0.6 }
"""


def drawn(seed, path_domain_m, ticks):
    """Inputs that jump, drift, and now and then leave their ranges."""
    rng = np.random.default_rng(seed)
    shortest, longest = path_domain_m
    holds = np.repeat(rng.uniform(-0.1, 1.1, ticks // 50 + 1), 50)[:ticks]
    swing = np.cumsum(rng.normal(0, 0.01, ticks))
    path = shortest + (longest - shortest) * (0.5 + 0.3 * np.sin(swing))
    return [holds, path, np.repeat(rng.uniform(0, 80, ticks // 100 + 1), 100)[:ticks]]


def assert_same(trace, expected):
    columns, status = expected
    for found, wanted in zip(trace[:3], columns, strict=True):
        assert bits(found) == wanted
    assert [names(flags) for flags in trace.status] == status


def names(flags):
    return "|".join(flag.name for flag in vm.Status if flag & int(flags)) or "ok"


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("arithmetic", ["f32", "fixed", "f64"])
def test_a_run_is_that_of_vm_run(vm_run, tmp_path, mode, arithmetic):
    file = tmp_path / "hand.toml"
    file.write_text(UNITS)
    muscle = vm.Muscle(file, mode=mode, arithmetic=arithmetic)
    assert muscle.accuracy_class == "economy"
    inputs = drawn(1, muscle.path_domain_m, 3000)
    trace = muscle.run(*inputs)
    assert trace.force_n.max() > 0.2 * muscle.max_isometric_force_n
    assert trace.status.any()
    assert_same(trace, vm_run(file, inputs, mode, arithmetic, "economy"))


@pytest.mark.parametrize("mode", MODES)
def test_the_reference_is_that_of_vm_run(vm_run, tmp_path, mode):
    file = tmp_path / "hand.toml"
    file.write_text(UNITS)
    muscle = vm.Muscle(file, mode=mode, arithmetic="reference")
    inputs = drawn(2, muscle.path_domain_m, 300)
    columns, _ = vm_run(file, inputs, mode, "reference")
    trace = muscle.run(*inputs)
    for found, wanted in zip(trace[:3], columns, strict=True):
        assert bits(found) == wanted
    assert not trace.status.any()


@pytest.mark.parametrize("accuracy_class", ["economy", "standard", "fine"])
@pytest.mark.parametrize("time_step_s", [1e-4, 2e-3])
def test_class_and_time_step_are_those_of_vm_run(vm_run, accuracy_class, time_step_s):
    muscle = vm.Muscle(
        "soleus", mode="fes", accuracy_class=accuracy_class, time_step_s=time_step_s
    )
    inputs = drawn(3, muscle.path_domain_m, 1000)
    expected = vm_run("soleus", inputs, "fes", "f32", accuracy_class, time_step_s)
    assert_same(muscle.run(*inputs), expected)


def test_every_named_muscle_is_that_of_vm_run(vm_run):
    assert len(vm.muscle_names()) == 20
    for name in vm.muscle_names():
        muscle = vm.Muscle(name)
        inputs = drawn(4, muscle.path_domain_m, 200)
        assert_same(muscle.run(*inputs), vm_run(name, inputs, "continuous", "f32"))


def test_a_dict_a_text_and_a_file_are_the_same_muscle(tmp_path):
    file = tmp_path / "hand.toml"
    file.write_text(UNITS)
    by_file = vm.Muscle(file, mode="discrete")
    inputs = drawn(5, by_file.path_domain_m, 300)
    expected = by_file.run(*inputs)
    numbers = tomllib.loads(UNITS)
    numbers["mass_g"] = np.float32(4)
    del numbers["name"]
    for muscle in [
        vm.Muscle(numbers, mode="discrete"),
        vm.Muscle.from_toml(UNITS, mode="discrete"),
        vm.Muscle.from_toml(by_file.to_toml(), mode="discrete"),
        vm.Muscle(str(file)).replace(mode="discrete"),
    ]:
        for found, wanted in zip(muscle.run(*inputs), expected, strict=True):
            np.testing.assert_array_equal(found, wanted)


def crc64(words):
    """CRC-64/XZ of 64-bit words, little end first."""
    table = []
    for byte in range(256):
        value = byte
        for _ in range(8):
            value = value >> 1 ^ (0xC96C5795D7870F42 if value & 1 else 0)
        table.append(value)
    remainder = 2**64 - 1
    for byte in np.asarray(words, dtype="<u8").tobytes():
        remainder = table[(remainder ^ byte) & 0xFF] ^ remainder >> 8
    return remainder ^ 2**64 - 1


@pytest.mark.parametrize("arithmetic", ["f32", "fixed", "f64"])
@pytest.mark.parametrize(
    "name, mode", [("fes_steps", "fes"), ("continuous_length_3hz", "continuous")]
)
def test_the_states_have_the_golden_bits(name, mode, arithmetic):
    assert crc64([]) == 0
    golden = tomllib.loads((DATA / "golden.toml").read_text())["state"]
    inputs = vector(name)
    state = vm.Muscle(PAPER, mode=mode, arithmetic=arithmetic).at_rest(inputs[1][0])
    saved = []
    # The first row is the muscle at rest.
    for row in list(zip(*inputs))[1:]:
        state.step(*map(float, row))
        # Golden checksums are without the fingerprint.
        saved.append(state.save()[1:])
    assert f"{crc64(np.concatenate(saved)):016x}" == golden[f"{name} {mode} {arithmetic}"]
