//! Muscles as words: the same bits as built ones; refusals of what is other, damaged or invalid.

use model_tests::muscles::{Discrete, Mode, any_coefficients, built, config, muscles, steps};
use proptest::prelude::*;
use vm_nostd::{
    Checksum, Class, Differs, EffectiveLength, ElementParams, FascicleLength, FiberParams,
    FiberType, Fixed, Input, IntramuscularFes, Muscle, MuscleParams, NaturalContinuous, Scalar,
    TimeStep, WordsError, feline_vm4, human_vm4, paper_table_1,
};

/// Words before the coefficients.
const HEADER: usize = 7;

fn emitted<S: Scalar, R: Mode<S>>(params: &MuscleParams<2>, step: TimeStep) -> Vec<u32> {
    let mut words = Vec::new();
    let units = R::units(params);
    Muscle::<S, R, 2>::emit(params, &units, step, |word| words.push(word)).expect("a valid muscle");
    words
}

fn read<S: Scalar, R: Mode<S>>(
    words: &[u32],
    class: Class,
    step: TimeStep,
) -> Result<Muscle<S, R, 2>, WordsError> {
    Muscle::from_words(words, class, step)
}

/// The words with the checksum of the others at their end.
fn sealed(mut words: Vec<u32>) -> Vec<u32> {
    let mut checksum = Checksum::EMPTY;
    words.pop();
    words.iter().for_each(|&word| checksum.add(word));
    words.push(checksum.value());
    words
}

/// Inputs that change from tick to tick, some of them invalid.
fn input<S: Scalar>(tick: u32, paths: (f64, f64)) -> Input<S> {
    let phase = f64::from(tick);
    let share = 0.5 + 0.6 * (0.05 * phase).sin();
    Input {
        activation: S::from_f64(0.5 + 0.6 * (0.11 * phase).sin()),
        path_length: S::path_length(paths.0 + share * (paths.1 - paths.0)),
        stimulation_frequency: S::quantity(if tick % 90 < 40 { 30.0 } else { -1.0 + phase }),
    }
}

/// Steps both muscles and compares all bits.
fn step_alike<S: Scalar, R: Mode<S>>(
    params: &MuscleParams<2>,
    muscles: [&Muscle<S, R, 2>; 2],
    ticks: u32,
) {
    let paths = params.path_domain();
    let middle = S::path_length(0.5 * (paths.0 + paths.1));
    let mut states = muscles.map(|muscle| muscle.rest(middle).expect("in range"));
    for tick in 0..ticks {
        let [first, second] = &mut states;
        let outputs = [(muscles[0], first), (muscles[1], second)]
            .map(|(muscle, state)| muscle.step(state, input(tick, paths)));
        let bits = outputs.map(|output| {
            let force = S::force_bits(output.force).into();
            let numbers = [output.relative_force, output.fascicle_length, output.fascicle_velocity];
            (force, numbers.map(|number| number.to_bits().into()), output.status)
        });
        assert_eq!(bits[0], bits[1], "tick {tick}");
    }
    let words = states.map(|state| state.words().collect::<Vec<_>>());
    assert_eq!(words[0], words[1]);
}

/// Both ways: the muscle from words is the built one, and emits the same words.
fn there_and_back<S: Scalar, R: Mode<S>>(params: &MuscleParams<2>, step: TimeStep, ticks: u32) {
    let words = emitted::<S, R>(params, step);
    assert_eq!(words.len(), Muscle::<S, R, 2>::WORDS);
    let muscle = read::<S, R>(&words, params.class, step).expect("its own words");
    let built = built::<S, R>(params, step);
    assert_eq!(muscle.checksum(), built.checksum());
    step_alike(params, [&built, &muscle], ticks);
}

fn in_every_mode_and_arithmetic(params: &MuscleParams<2>, step: TimeStep, ticks: u32) {
    fn in_every_mode<S: Scalar>(params: &MuscleParams<2>, step: TimeStep, ticks: u32) {
        there_and_back::<S, NaturalContinuous>(params, step, ticks);
        there_and_back::<S, IntramuscularFes>(params, step, ticks);
        there_and_back::<S, Discrete<FascicleLength>>(params, step, ticks);
        there_and_back::<S, Discrete<EffectiveLength>>(params, step, ticks);
    }
    in_every_mode::<f32>(params, step, ticks);
    in_every_mode::<f64>(params, step, ticks);
    in_every_mode::<Fixed>(params, step, ticks);
}

fn of_types(elements: ElementParams, types: [FiberType; 2]) -> MuscleParams<2> {
    MuscleParams {
        mass: 0.05,
        fascicle_length: 0.08,
        tendon_length: 0.1,
        max_path_length: 0.2,
        recruitment_saturation: 0.8,
        class: Class::Standard,
        elements,
        fibers: [
            FiberParams { fraction: 0.6, fiber_type: types[0] },
            FiberParams { fraction: 0.4, fiber_type: types[1] },
        ],
    }
}

/// Every pair of published types, in order of rank.
fn presets() -> Vec<MuscleParams<2>> {
    let sets: [(ElementParams, &[FiberType]); 3] = [
        (paper_table_1::ELEMENTS, &[paper_table_1::SLOW, paper_table_1::FAST]),
        (human_vm4::ELEMENTS, &[human_vm4::SUPER_SLOW, human_vm4::SLOW, human_vm4::FAST]),
        (feline_vm4::ELEMENTS, &[feline_vm4::SUPER_SLOW, feline_vm4::SLOW, feline_vm4::FAST]),
    ];
    let pairs = sets.into_iter().flat_map(|(elements, types)| {
        let pairs =
            types.iter().flat_map(move |first| types.iter().map(move |second| (first, second)));
        pairs.map(move |(first, second)| of_types(elements, [*first, *second]))
    });
    pairs.filter(|params| params.validate().is_ok()).collect()
}

#[test]
fn a_muscle_from_words_steps_with_the_bits_of_a_built_one() {
    let presets = presets();
    assert!(presets.len() >= 11, "{}", presets.len());
    for params in presets {
        for class in [Class::Economy, Class::Standard, Class::Fine] {
            for seconds in [1e-3, 0.4e-3] {
                let step = TimeStep::from_seconds(seconds).expect("a step");
                in_every_mode_and_arithmetic(&MuscleParams { class, ..params }, step, 400);
            }
        }
    }
}

proptest! {
    #![proptest_config(config(150))]

    #[test]
    fn every_valid_muscle_is_read_back(
        params in prop_oneof![muscles(), any_coefficients()],
        step in steps(),
    ) {
        prop_assume!(Muscle::<Fixed, NaturalContinuous, 2>::build(&params, step).is_ok());
        in_every_mode_and_arithmetic(&params, step, 40);
    }
}

fn paper() -> MuscleParams<2> {
    of_types(paper_table_1::ELEMENTS, [paper_table_1::SLOW, paper_table_1::FAST])
}

/// The error of words.
fn refusal<S: Scalar, R: Mode<S>>(words: &[u32]) -> WordsError {
    read::<S, R>(words, Class::Standard, TimeStep::MILLISECOND).err().expect("refused")
}

#[test]
fn words_of_something_else_are_refused_by_name() {
    let step = TimeStep::MILLISECOND;
    let other = |words: &[u32]| match refusal::<f32, IntramuscularFes>(words) {
        WordsError::Other { what, found, expected } => {
            assert_ne!(found, expected, "{what:?}");
            what
        }
        error => panic!("{error}"),
    };
    let params = paper();
    let own = emitted::<f32, IntramuscularFes>(&params, step);
    let mut changed = own.clone();
    changed[0] += 1;
    assert_eq!(other(&sealed(changed.clone())), Differs::Version);
    let text = refusal::<f32, IntramuscularFes>(&changed).to_string();
    assert_eq!(text, "words: version = 0.1.1: must be 0.1.0");
    assert_eq!(other(&emitted::<Fixed, IntramuscularFes>(&params, step)), Differs::Arithmetic);
    assert_eq!(other(&emitted::<f32, NaturalContinuous>(&params, step)), Differs::Mode);
    let one_type = MuscleParams {
        mass: 0.05,
        fascicle_length: 0.08,
        tendon_length: 0.1,
        max_path_length: 0.2,
        recruitment_saturation: 0.8,
        class: Class::Standard,
        elements: params.elements,
        fibers: [FiberParams { fraction: 1.0, fiber_type: paper_table_1::SLOW }],
    };
    let mut words = Vec::new();
    let add = |word| words.push(word);
    Muscle::<f32, IntramuscularFes, 1>::emit(&one_type, &(), step, add).expect("valid");
    assert_eq!(other(&words), Differs::Types);
    let fine = MuscleParams { class: Class::Fine, ..params };
    assert_eq!(other(&emitted::<f32, IntramuscularFes>(&fine, step)), Differs::Class);
    let slower = TimeStep::from_seconds(1.1e-3).expect("a step");
    let words = emitted::<f32, IntramuscularFes>(&params, slower);
    assert_eq!(other(&words), Differs::TimeStep);
    let text = refusal::<f32, IntramuscularFes>(&words).to_string();
    assert_eq!(text, "words: time step = 0.0011 s: must be 0.001 s");
    let mut changed = own.clone();
    changed[6] ^= 1;
    assert_eq!(other(&sealed(changed)), Differs::Layout);
}

/// 1.1 ms, computed in two ways that differ by rounding.
#[test]
fn a_time_step_is_the_same_whatever_its_last_bits() {
    let steps = [1.1e-3, 1100.0 * 1e-6].map(|s| TimeStep::from_seconds(s).expect("a step"));
    assert_ne!(steps[0], steps[1]);
    let words = emitted::<f32, IntramuscularFes>(&paper(), steps[0]);
    assert!(read::<f32, IntramuscularFes>(&words, Class::Standard, steps[1]).is_ok());
}

#[test]
fn every_length_but_the_right_one_is_refused() {
    let words = emitted::<Fixed, IntramuscularFes>(&paper(), TimeStep::MILLISECOND);
    let expected = words.len();
    for found in (0..expected).chain([expected + 1, expected + 100]) {
        let mut other = words.clone();
        other.resize(found, 0);
        let error = refusal::<Fixed, IntramuscularFes>(&other);
        assert_eq!(error, WordsError::Length { found, expected });
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    fn all<S: Scalar, R: Mode<S>>() {
        let words = emitted::<S, R>(&paper(), TimeStep::MILLISECOND);
        for word in 0..words.len() {
            for bit in 0..32 {
                let mut other = words.clone();
                other[word] ^= 1 << bit;
                let error = refusal::<S, R>(&other);
                let damaged = matches!(error, WordsError::Checksum { .. });
                assert_eq!(damaged, word >= HEADER, "word {word}, bit {bit}: {error}");
            }
        }
    }
    all::<f32, IntramuscularFes>();
    all::<Fixed, Discrete<EffectiveLength>>();
}

#[test]
fn no_value_of_floating_point_may_be_infinite_or_not_a_number() {
    fn all<R: Mode<f32>>(integers: usize) {
        let words = emitted::<f32, R>(&paper(), TimeStep::MILLISECOND);
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let accepted = (HEADER..words.len() - 1).filter(|&word| {
                let mut other = words.clone();
                other[word] = value.to_bits();
                read::<f32, R>(&sealed(other), Class::Standard, TimeStep::MILLISECOND).is_ok()
            });
            assert_eq!(accepted.count(), integers, "{value}");
        }
    }
    all::<IntramuscularFes>(0);
    all::<NaturalContinuous>(0);
    all::<Discrete<EffectiveLength>>(0);
}

/// Steps whatever was accepted.
fn step_anything<S: Scalar, R: Mode<S>>(words: &[u32]) -> bool {
    let Ok(muscle) = read::<S, R>(words, Class::Standard, TimeStep::MILLISECOND) else {
        return false;
    };
    let paths = muscle.path_length_range();
    for path in [paths.0, paths.1] {
        let Ok(mut state) = muscle.rest(path) else { continue };
        for tick in 0..60 {
            muscle.step(&mut state, input(tick, (0.1, 0.3)));
        }
    }
    true
}

/// Any word, and those at the ends of a format.
fn any_word() -> impl Strategy<Value = u32> {
    let ends = [0, 1, 2, 63, u32::MAX, 0x7fff_ffff, 0x8000_0000, 0x7f7f_ffff, 0xff7f_ffff, 1];
    prop_oneof![any::<u32>(), prop::sample::select(ends.to_vec())]
}

proptest! {
    #![proptest_config(config(2000))]

    /// Words that nobody emitted, with a valid checksum: refused or stepped, without a panic.
    #[test]
    fn no_words_make_anything_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any_word()), 1..4),
    ) {
        fn changed<S: Scalar, R: Mode<S>>(changes: &[(prop::sample::Index, u32)]) {
            let mut words = emitted::<S, R>(&paper(), TimeStep::MILLISECOND);
            for (index, word) in changes {
                let place = HEADER + index.index(words.len() - HEADER - 1);
                words[place] = *word;
            }
            step_anything::<S, R>(&sealed(words));
        }
        changed::<f32, IntramuscularFes>(&changes);
        changed::<Fixed, NaturalContinuous>(&changes);
        changed::<f32, Discrete<EffectiveLength>>(&changes);
        changed::<Fixed, Discrete<EffectiveLength>>(&changes);
    }

    #[test]
    fn no_words_at_all_make_anything_panic(
        words in prop::collection::vec(any_word(), 0..300),
        header in any::<bool>(),
    ) {
        let mut words = words;
        if header {
            let own = emitted::<Fixed, IntramuscularFes>(&paper(), TimeStep::MILLISECOND);
            words.resize(own.len(), 0);
            words[..HEADER].copy_from_slice(&own[..HEADER]);
        } else {
            prop_assert!(!step_anything::<Fixed, IntramuscularFes>(&words));
        }
        step_anything::<Fixed, IntramuscularFes>(&sealed(words));
    }
}

#[test]
fn invalid_values_are_refused() {
    fn refused<S: Scalar, R: Mode<S>>() -> (usize, usize) {
        let words = emitted::<S, R>(&paper(), TimeStep::MILLISECOND);
        let places = HEADER..words.len() - 1;
        let count = places.len();
        let refused = places.filter(|&place| {
            [0x7fff_ffff, 0x8000_0000, 0xffff_ffff].into_iter().any(|value| {
                let mut other = words.clone();
                other[place] = value;
                let other = sealed(other);
                let read = read::<S, R>(&other, Class::Standard, TimeStep::MILLISECOND);
                matches!(read.err(), Some(WordsError::Value { word }) if word >= place)
            })
        });
        (refused.count(), count)
    }
    let (refused_words, all) = refused::<f32, IntramuscularFes>();
    assert_eq!(refused_words, all, "not-a-numbers in f32");
    let (refused_words, all) = refused::<Fixed, IntramuscularFes>();
    assert!(refused_words > all / 4, "{refused_words} of {all}");
    let (refused_words, all) = refused::<Fixed, Discrete<EffectiveLength>>();
    assert!(refused_words > all / 4, "{refused_words} of {all}");
}
