"""What is refused, before anything runs: with field, value and limit."""

import subprocess
import sys

import numpy as np
import pytest
from conftest import DATA

import vm_nostd as vm

GOOD = [np.zeros(5), np.full(5, 0.16), np.full(5, 30.0)]
NAMES = ["activation", "path_length_m", "stimulation_frequency_pps"]


def with_changed(index, column):
    return [column if place == index else kept for place, kept in enumerate(GOOD)]


@pytest.fixture(params=["muscle", "state"])
def runs(request, paper):
    """`run` of a muscle and of a state, which must stay as it was."""
    if request.param == "muscle":
        yield paper.run
        return
    state = paper.at_rest(0.16)
    state.step(1, 0.16, 30)
    before = state.save()
    yield state.run
    np.testing.assert_array_equal(state.save(), before)


@pytest.mark.parametrize("index", range(3))
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused_by_row(runs, index, bad):
    column = GOOD[index].copy()
    column[3] = bad
    with pytest.raises(vm.ParameterError) as refused:
        runs(*with_changed(index, column))
    assert refused.value.field == f"{NAMES[index]}[3]"
    assert refused.value.value == pytest.approx(bad, nan_ok=True)
    assert refused.value.limit == "must be finite"


@pytest.mark.parametrize("index", range(3))
def test_arrays_of_other_lengths_are_refused(runs, index):
    with pytest.raises(vm.ParameterError, match="4 numbers|5 numbers") as refused:
        runs(*with_changed(index, GOOD[index][:4]))
    assert isinstance(refused.value, ValueError)


@pytest.mark.parametrize("index", range(3))
@pytest.mark.parametrize(
    "column",
    [["a"] * 5, np.zeros(5, complex), np.zeros(5, bool), [None] * 5, [[0.1], [0.1, 0.2]], "0.16"],
)
def test_what_is_not_real_numbers_is_refused(runs, index, column):
    with pytest.raises(TypeError, match=f"{NAMES[index]} is .*: must be a real number"):
        runs(*with_changed(index, column))


@pytest.mark.parametrize("index", range(3))
def test_tables_are_refused(runs, index):
    with pytest.raises(vm.ParameterError, match="2 dimensions: must be a number or one-dim"):
        runs(*with_changed(index, np.full((5, 1), 0.16)))


def test_numbers_alone_have_no_rows(runs):
    with pytest.raises(vm.ParameterError, match="one input at least must be an array"):
        runs(1, 0.16, 30)


def test_a_run_of_no_row_has_no_rest(paper):
    with pytest.raises(vm.ParameterError, match="must be at least 1"):
        paper.run([], 0.16, 30)


def test_integers_lists_and_strides_are_taken(paper):
    expected = paper.run(np.ones(4), np.full(4, 0.16), np.full(4, 30.0))
    for activation, frequency in [
        ([1, 1, 1, 1], 30),
        (np.ones(8, np.float32)[::2], np.full(4, 30, np.uint8)),
        (np.ones(4, ">f8"), [30.0] * 4),
    ]:
        found = paper.run(activation, 0.16, frequency)
        np.testing.assert_array_equal(found.force_n, expected.force_n)


def test_out_of_range_inputs_are_clipped_and_flagged(paper):
    state = paper.at_rest(0.16)
    clipped = vm.Status.ACTIVATION_CLIPPED | vm.Status.FREQUENCY_CLIPPED
    assert state.step(1.2, 0.16, 501).status == clipped
    assert state.step(1, 9, 30).status & vm.Status.PATH_LENGTH_CLIPPED


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_step_refuses_what_is_not_finite(paper, bad):
    state = paper.at_rest(0.16)
    for index, name in enumerate(NAMES):
        arguments = [1, 0.16, 30]
        arguments[index] = bad
        with pytest.raises(vm.ParameterError, match=f"{name} = .*must be finite"):
            state.step(*arguments)


def test_fes_needs_a_frequency(paper):
    with pytest.raises(vm.ParameterError, match="stimulation_frequency_pps = None"):
        paper.run(np.ones(3), 0.16)
    with pytest.raises(vm.ParameterError, match="stimulation_frequency_pps = None"):
        paper.at_rest(0.16).step(1, 0.16)
    vm.Muscle("soleus").at_rest(0.3).step(1, 0.3)


@pytest.mark.parametrize("arithmetic", ["f32", "fixed", "f64", "reference"])
@pytest.mark.parametrize("path", [0.01, 9.0, np.nan])
def test_no_muscle_rests_outside_of_its_domain(paper, arithmetic, path):
    muscle = paper.replace(arithmetic=arithmetic)
    with pytest.raises(vm.ParameterError) as refused:
        muscle.at_rest(path)
    assert refused.value.field == "path_length_m"
    shortest, longest = muscle.path_domain_m
    assert f"{shortest}" in refused.value.limit and f"{longest}" in refused.value.limit


@pytest.mark.parametrize(
    "change, field, value, limit",
    [
        ({"mass_g": -1}, "mass_g", -1, "must be between 0.01 and 30000"),
        ({"tendon_length_cm": np.nan}, "tendon_length_cm", np.nan, "must be between 0.05 and 200"),
        ({"class": "coarse"}, "class", '"coarse"', "must be one of economy, standard, fine"),
        ({"coefficients": "rat"}, "coefficients", '"rat"', "must be one of "),
        ({"fiber": []}, "fiber", "0 tables", "a muscle has 1 to 6 fibre types"),
    ],
)
def test_a_dict_is_refused_with_field_value_and_limit(change, field, value, limit):
    muscle = {
        "mass_g": 97.5,
        "fascicle_length_cm": 11,
        "tendon_length_cm": 2,
        "max_path_length_cm": 18.4,
        "fiber": [{"preset": "paper-table-1/slow", "fraction": 1}],
    }
    vm.Muscle(muscle)
    with pytest.raises(vm.ParameterError) as refused:
        vm.Muscle(muscle | change)
    assert refused.value.field == field
    assert refused.value.value == pytest.approx(value, nan_ok=True)
    assert limit in refused.value.limit


def test_a_dict_without_end_or_of_odd_things_is_refused_by_its_key():
    # In a process of its own: what went wrong once ended it.
    code = """
import itertools
import numpy as np
import vm_nostd as vm
inside, endless = {}, []
inside["x"] = inside
endless.append(endless)
for bad, error in [
    ({"elements": inside}, vm.ParameterError),
    ({"fiber": endless}, vm.ParameterError),
    ({"mass_g": 10**30}, vm.ParameterError),
    ({"fiber": itertools.count()}, TypeError),
    ({"fiber": {1, 2}}, TypeError),
]:
    (key,) = bad
    try:
        vm.Muscle(bad)
    except error as refused:
        assert f"muscle.{key}" in str(refused), refused
    else:
        raise AssertionError(bad)
paper = {"mass_g": np.longdouble(97.5), "fascicle_length_cm": np.float32(11),
         "tendon_length_cm": np.int8(2), "max_path_length_cm": 18.4,
         "fiber": ({"preset": np.str_("paper-table-1/slow"), "fraction": np.array(1)},)}
assert vm.Muscle(paper).mass_kg == 0.0975
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ran.returncode == 0, ran.stderr


def test_a_file_or_list_that_cannot_be_read_is_a_refused_value(paper, tmp_path):
    file = tmp_path / "muscle.toml"
    file.write_text("mass_g =")
    for refuse, field, value in [
        (lambda: vm.Muscle({"mas_g": 1}), "muscle", "dict"),
        (lambda: vm.Muscle.from_toml("name = 3"), "muscle", "text"),
        (lambda: vm.Muscle(file), "muscle", str(file)),
        (lambda: vm.fit(paper, {"trails": []}), "trials", "dict"),
        (lambda: vm.fit(paper, {"trial": []}, starts=-1), "starts", -1),
        (lambda: vm.fit(paper, {"trial": []}, seed=-1), "seed", -1),
        (lambda: paper.curves().passive(np.ma.array([1, 2.0], mask=[0, 1])), None, "masked"),
        (lambda: paper.curves().force_length(-1, 1.0), "fiber", -1),
    ]:
        with pytest.raises(vm.ParameterError) as refused:
            refuse()
        assert refused.value.value == value
        assert field is None or refused.value.field == field
    assert paper.curves().passive(np.ma.array([1, 1.0])).shape == (2,)


@pytest.mark.parametrize("words", [[1, 2], None, np.zeros(22), np.zeros((1, 22), np.uint64)])
def test_words_of_another_type_are_refused_by_name(paper, words):
    for kept in [paper.at_rest(0.16), vm.Fatigue.quadriceps()]:
        with pytest.raises(TypeError, match="words is .*: must be the uint64 array that save"):
            kept.restore(words)


def test_files_names_and_words_are_refused(tmp_path):
    with pytest.raises(vm.ParameterError, match="muscle = soleuss: must be a file, or one of"):
        vm.Muscle("soleuss")
    with pytest.raises(OSError):
        vm.Muscle(tmp_path)
    with pytest.raises(TypeError, match="muscle is .*: must be a name"):
        vm.Muscle(3)
    with pytest.raises(ValueError, match="unknown field `mass`"):
        vm.Muscle({"mass": 1})
    with pytest.raises(TypeError, match=r"muscle\.fiber\[0\].* is .*object"):
        vm.Muscle({"fiber": [object()]})
    file = tmp_path / "muscle.toml"
    text = (DATA / "muscles/deltoid_posterior.toml").read_text()
    file.write_text(text.replace("mass_g = 97.5", "mass_g = 0"))
    with pytest.raises(vm.ParameterError, match="muscle.toml, line 3: mass_g = 0"):
        vm.Muscle(file)
    for choice in [{"mode": "electric"}, {"arithmetic": "f16"}, {"accuracy_class": "coarse"}]:
        ((name, value),) = choice.items()
        with pytest.raises(vm.ParameterError, match=f"{name} = {value}: must be one of"):
            vm.Muscle("soleus", **choice)
    with pytest.raises(vm.ParameterError, match="time_step_s = 0.1: must be 0.0001 to 0.002"):
        vm.Muscle("soleus", time_step_s=0.1)


def test_a_muscle_without_units_has_no_discrete_mode():
    with pytest.raises(vm.ParameterError, match="units"):
        vm.Muscle("soleus", mode="discrete")
