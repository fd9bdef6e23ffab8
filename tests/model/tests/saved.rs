//! A saved state has a fingerprint: another muscle, mode, time step or arithmetic refuses it.

use model_tests::muscles::{Discrete, Mode};
use vm_nostd::{
    Class, EffectiveLength, FascicleLength, Fixed, Input, IntramuscularFes, MotorUnits, Muscle,
    MuscleParams, NaturalContinuous, NaturalDiscrete, Recruitment, RestoreError, Scalar, State,
    TimeStep, UnitSizes,
};
use vm_nostd_cores::MUSCLE;

type Params = MuscleParams<2>;
/// Change of a parameter.
type Change = fn(&mut Params);

fn built<S: Scalar, R: Mode<S>>(params: &Params, step: TimeStep) -> Muscle<S, R, 2> {
    model_tests::muscles::built(params, step)
}

/// Words of a saved state after some ticks.
fn saved<S: Scalar, R: Recruitment<S, 2>>(muscle: &Muscle<S, R, 2>) -> Vec<S::Bits> {
    let path_length = S::path_length(0.16);
    let input = Input {
        activation: S::from_f64(0.5),
        path_length,
        stimulation_frequency: S::quantity(30.0),
    };
    let mut state = muscle.rest(path_length).expect("in range");
    for _ in 0..100 {
        muscle.step(&mut state, input);
    }
    let words: Vec<S::Bits> = muscle.save(&state).collect();
    assert_eq!(words.len(), State::<S, R, 2>::SAVED_WORDS);
    assert_eq!(muscle.restore(words.iter().copied()), Ok(state));
    // Words without a fingerprint are refused.
    assert!(muscle.restore(state.words()).is_err());
    words
}

fn assert_refused_as_another_muscles<S: Scalar, R: Recruitment<S, 2>>(
    muscle: &Muscle<S, R, 2>,
    words: &[S::Bits],
    what: &str,
) {
    match muscle.restore(words.iter().copied()).expect_err(what) {
        RestoreError::OtherMuscle { saved, expected } => {
            assert!(saved == Into::<u64>::into(words[0]) && saved != u64::from(expected), "{what}");
        }
        other => panic!("{what}: {other}"),
    }
}

fn step(seconds: f64) -> TimeStep {
    TimeStep::from_seconds(seconds).expect("a step")
}

fn only_the_same_muscle_accepts_a_state<S: Scalar, R: Mode<S>>() {
    let ms = TimeStep::MILLISECOND;
    let words = saved::<S, R>(&built(&MUSCLE, ms));
    // A muscle built again from the same parameters accepts it.
    assert!(built::<S, R>(&MUSCLE, ms).restore(words.iter().copied()).is_ok());
    let changes: [(&str, Change); 7] = [
        ("mass", |p| p.mass *= 1.001),
        ("fascicle", |p| p.fascicle_length *= 1.001),
        ("tendon", |p| p.tendon_length *= 1.001),
        ("longest path", |p| p.max_path_length *= 1.001),
        ("elements", |p| p.elements.parallel.viscosity *= 1.001),
        ("fractions", |p| (p.fibers[0].fraction, p.fibers[1].fraction) = (0.601, 0.399)),
        ("fibres", |p| p.fibers[1].fiber_type.activation.scale *= 1.001),
    ];
    for (what, change) in changes {
        let mut params = MUSCLE;
        change(&mut params);
        if what == "fractions" && params.validate().is_err() {
            continue;
        }
        assert_refused_as_another_muscles(&built::<S, R>(&params, ms), &words, what);
    }
    for seconds in [0.5e-3, 0.999e-3, 2e-3] {
        assert_refused_as_another_muscles(
            &built::<S, R>(&MUSCLE, step(seconds)),
            &words,
            "time step",
        );
    }
}

fn in_all_modes<S: Scalar>() {
    only_the_same_muscle_accepts_a_state::<S, NaturalContinuous>();
    only_the_same_muscle_accepts_a_state::<S, IntramuscularFes>();
    only_the_same_muscle_accepts_a_state::<S, Discrete<FascicleLength>>();
    only_the_same_muscle_accepts_a_state::<S, Discrete<EffectiveLength>>();
    // States of natural recruitment and FES have the same layout.
    let ms = TimeStep::MILLISECOND;
    let natural = saved::<S, NaturalContinuous>(&built(&MUSCLE, ms));
    assert_refused_as_another_muscles(&built::<S, IntramuscularFes>(&MUSCLE, ms), &natural, "mode");
    let stimulated = saved::<S, IntramuscularFes>(&built(&MUSCLE, ms));
    assert_refused_as_another_muscles(
        &built::<S, NaturalContinuous>(&MUSCLE, ms),
        &stimulated,
        "mode",
    );
}

#[test]
fn another_muscle_mode_or_time_step_refuses_a_saved_state() {
    in_all_modes::<f32>();
    in_all_modes::<f64>();
    in_all_modes::<Fixed>();
}

#[test]
fn arithmetics_refuse_each_others_states() {
    let ms = TimeStep::MILLISECOND;
    let float = saved::<f32, IntramuscularFes>(&built(&MUSCLE, ms));
    assert_refused_as_another_muscles(
        &built::<Fixed, IntramuscularFes>(&MUSCLE, ms),
        &float,
        "arithmetic",
    );
}

#[test]
fn motor_units_are_part_of_the_fingerprint() {
    let ms = TimeStep::MILLISECOND;
    type Units = NaturalDiscrete<FascicleLength, 8>;
    let muscle = |sizes: [UnitSizes<'_>; 2]| {
        let units = MotorUnits::<8>::new(&MUSCLE, sizes).expect("units");
        Muscle::<f32, Units, 2>::build_with_units(&MUSCLE, &units, ms).expect("a muscle")
    };
    let words = saved(&muscle([UnitSizes::Default(3); 2]));
    assert_refused_as_another_muscles(&muscle([UnitSizes::Equal(3); 2]), &words, "sizes");
    assert_refused_as_another_muscles(
        &muscle([UnitSizes::Default(4), UnitSizes::Default(2)]),
        &words,
        "their number",
    );
}

/// On a path that jumps across its whole range every tick, short fascicles exceed the clamped
/// velocity within a tick.
fn restores_what_a_step_leaves<S: Scalar>(class: Class) {
    let mut params = Params { class, fascicle_length: 0.01, tendon_length: 0.001, ..MUSCLE };
    params.max_path_length += (1.2 - params.maximum_fascicle_length()) * params.fascicle_length;
    let muscle =
        built::<S, IntramuscularFes>(&params, TimeStep::from_seconds(1e-4).expect("a time step"));
    let ends: [S::PathLength; 2] = muscle.path_length_range().into();
    let mut state = muscle.rest(ends[0]).expect("in range");
    let input = |tick: usize| Input {
        activation: S::from_f64(0.5),
        path_length: ends[(tick + 1) % 2],
        stimulation_frequency: S::quantity(30.0),
    };
    for tick in 0..50 {
        muscle.step(&mut state, input(tick));
        assert_eq!(muscle.restore(muscle.save(&state)), Ok(state), "{class:?}, tick {tick}");
    }
}

#[test]
fn every_state_that_a_step_leaves_is_restored() {
    for class in [Class::Economy, Class::Standard, Class::Fine] {
        restores_what_a_step_leaves::<f32>(class);
        restores_what_a_step_leaves::<f64>(class);
        restores_what_a_step_leaves::<Fixed>(class);
    }
}
