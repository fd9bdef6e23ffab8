"""Fits of recordings that the reference makes."""

import numpy as np
import pytest
import vm_nostd as vm


def trials(force_n, **changes):
    trial = {
        "name": "tetanus",
        "role": "fit",
        "mode": "fes",
        "force": {"time_s": np.arange(len(force_n)) * 1e-3, "value": force_n},
        "length": {"constant": 0.16},
        "activation": {"steps": [[0, 0], [0.1, 1], [0.5, 0]]},
        "stimulation_pps": {"constant": 40},
    }
    return {
        "noise_pct_f0": 1,
        "trial": [trial | changes],
        "free": [{"name": "max_isometric_force_n", "bounds": [100, 600]}],
    }


def recording(paper):
    seconds = np.arange(801) * 1e-3
    train = np.where((seconds > 0.1) & (seconds <= 0.5), 1.0, 0.0)
    force = paper.replace(arithmetic="reference").run(train, 0.16, 40).force_n
    return 1.2 * force + np.random.default_rng(1).normal(0, 2.7, len(force))


def test_a_fit_finds_f0_and_is_a_muscle(paper):
    force = recording(paper)
    fit = vm.fit(paper, trials(force), starts=1)
    (estimate,) = fit.estimates
    assert estimate.name == "max_isometric_force_n"
    assert estimate.value == pytest.approx(1.2 * paper.max_isometric_force_n, rel=0.02)
    least, most = estimate.interval
    assert least < estimate.value < most
    (trial,) = fit.trials
    np.testing.assert_array_equal(trial.measured_n, force)
    assert (trial.name, trial.role) == ("tetanus", "fit") and trial.rms_error_pct < 2
    assert 0.7 < fit.noise_ratio < 1.4 and fit.pairs == []
    fitted = vm.Muscle.from_toml(fit.to_toml(), mode="fes")
    assert fitted.max_isometric_force_n == pytest.approx(estimate.value)
    again = vm.fit(paper, trials(force), starts=1)
    assert again.to_toml() == fit.to_toml()


def test_a_list_in_a_file_is_the_same_fit(paper, tmp_path):
    force = recording(paper)
    columns = np.column_stack([np.arange(801) * 1e-3, force])
    np.savetxt(tmp_path / "force.csv", columns, "%.17g", ",")
    (tmp_path / "trials.toml").write_text(
        """noise_pct_f0 = 1
        [[trial]]
        name = "tetanus"
        role = "fit"
        mode = "fes"
        force = { file = "force.csv", time = 1, value = 2 }
        length = { constant = 0.16 }
        activation = { steps = [[0, 0], [0.1, 1], [0.5, 0]] }
        stimulation_pps = { constant = 40 }
        [[free]]
        name = "max_isometric_force_n"
        bounds = [100, 600]
        """
    )
    by_file = vm.fit(paper, tmp_path / "trials.toml", starts=1)
    assert by_file.estimates == vm.fit(paper, trials(force), starts=1).estimates


def test_recordings_that_are_no_good_are_refused(paper):
    force = recording(paper)
    broken = force.copy()
    broken[7] = np.nan
    with pytest.raises(vm.ParameterError, match=r"trial\[0\]\.force\.value\[7\] = nan: must"):
        vm.fit(paper, trials(broken))
    time_s = np.arange(len(force)) * 1e-3
    masked = np.ma.array(force, mask=np.isnan(broken))
    with pytest.raises(vm.ParameterError, match="force.value = masked"):
        vm.fit(paper, trials(masked))
    for column in [force * 1j, force > 3, ["a"] * 801]:
        with pytest.raises(TypeError, match="force.value is .*: must be a real number"):
            vm.fit(paper, trials(force, force={"time_s": time_s, "value": column}))
    with pytest.raises(vm.ParameterError, match="force = time_s alone"):
        vm.fit(paper, trials(force, force={"time_s": time_s}))
    for trial in ["x", 3, [3]]:
        with pytest.raises(vm.ParameterError, match="(?s)trials = dict: .*invalid type"):
            vm.fit(paper, trials(force) | {"trial": trial})
    short = {"time_s": np.arange(5), "value": force[:4]}
    with pytest.raises(vm.ParameterError, match=r"trial\[0\].force = .*: time_s and value must"):
        vm.fit(paper, trials(force, force=short))
    with pytest.raises(ValueError, match="unknown field `forces`"):
        vm.fit(paper, trials(force, forces=1))
    with pytest.raises(vm.ParameterError, match="starts = 0: must be 1 to 1000"):
        vm.fit(paper, trials(force), starts=0)
    with pytest.raises(ValueError, match="lengths"):
        vm.fit(paper, trials(force) | {"free": [{"name": "lengths", "start": 1, "bounds": [0, 2]}]})
    with pytest.raises(ValueError, match="no/such/file.toml: No such file"):
        vm.fit(paper, "no/such/file.toml")
