//! Muscles, time steps and settings shared by the property tests.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use vm_nostd::{
    ActingLength, Class, ElementParams, FiberParams, FiberType, Fixed, IntramuscularFes,
    MotorUnits, Muscle, MuscleParams, NaturalContinuous, NaturalDiscrete, Recruitment, Scalar,
    TimeStep, UnitSizes, feline_vm4, human_vm4, paper_table_1,
};

/// Fibre types of these muscles.
pub const TYPES: usize = 2;

/// A recruitment mode of the property tests.
pub trait Mode<S: Scalar>: Recruitment<S, TYPES> {
    /// Data of a muscle besides its parameters.
    fn units(params: &MuscleParams<TYPES>) -> Self::Units;
}

impl<S: Scalar> Mode<S> for NaturalContinuous {
    fn units(_: &MuscleParams<TYPES>) {}
}

impl<S: Scalar> Mode<S> for IntramuscularFes {
    fn units(_: &MuscleParams<TYPES>) {}
}

/// Seven motor units, with a capacity of eight.
pub type Discrete<A> = NaturalDiscrete<A, 8>;

impl<S: Scalar, A: ActingLength<S>> Mode<S> for Discrete<A> {
    fn units(params: &MuscleParams<TYPES>) -> MotorUnits<8> {
        let sizes = [UnitSizes::Default(3), UnitSizes::Geometric(4, 0.3)];
        MotorUnits::new(params, sizes).expect("valid units")
    }
}

/// A valid muscle in a mode.
pub fn built<S: Scalar, R: Mode<S>>(
    params: &MuscleParams<TYPES>,
    step: TimeStep,
) -> Muscle<S, R, TYPES> {
    let units = R::units(params);
    Muscle::build_with_units(params, &units, step).expect("a valid muscle")
}

/// A fixed seed, so that a failure is due to the change under test; PROPTEST_RNG_SEED sets another.
pub fn config(cases: u32) -> ProptestConfig {
    let default = ProptestConfig::default();
    let rng_seed = match default.rng_seed {
        RngSeed::Random => RngSeed::Fixed(0x6d75_7363_6c65),
        fixed => fixed,
    };
    ProptestConfig { cases, rng_seed, failure_persistence: None, ..default }
}

/// A slow and a fast type of one set with small variations.
fn types() -> impl Strategy<Value = (ElementParams, [FiberType; TYPES])> {
    let sets = prop_oneof![
        Just((paper_table_1::ELEMENTS, [paper_table_1::SLOW, paper_table_1::FAST])),
        Just((human_vm4::ELEMENTS, [human_vm4::SUPER_SLOW, human_vm4::FAST])),
        Just((human_vm4::ELEMENTS, [human_vm4::SLOW, human_vm4::SLOW])),
        Just((feline_vm4::ELEMENTS, [feline_vm4::SLOW, feline_vm4::FAST])),
    ];
    let share = || 0.8..1.25_f64;
    (sets, [share(), share(), share(), share(), share()]).prop_map(|((elements, types), vary)| {
        let varied = types.map(|mut t| {
            t.half_force_frequency *= vary[0];
            t.force_velocity.maximum_velocity *= vary[1];
            t.activation.scale *= vary[2];
            t.excitation.rise *= vary[3];
            t.excitation.fall *= vary[4];
            t
        });
        (elements, varied)
    })
}

/// Muscles of every published set, in a wide range of sizes.
pub fn muscles() -> impl Strategy<Value = MuscleParams<TYPES>> {
    (types(), 1e-3..1.0_f64, 0.02..0.3_f64, 0.01..0.3_f64, 0.05..0.95_f64, 0.2..1.0_f64, 1.15..1.6)
        .prop_map(|((elements, types), mass, fascicle, tendon, fraction, saturation, longest)| {
            let mut params = MuscleParams {
                mass,
                fascicle_length: fascicle,
                tendon_length: tendon,
                max_path_length: fascicle + tendon,
                recruitment_saturation: saturation,
                class: Class::Standard,
                elements,
                fibers: [
                    FiberParams { fraction, fiber_type: types[0] },
                    FiberParams { fraction: 1.0 - fraction, fiber_type: types[1] },
                ],
            };
            // The longest path at which passive fascicles reach the length `longest`.
            params.max_path_length += (longest - params.maximum_fascicle_length()) * fascicle;
            params
        })
        .prop_filter("a valid muscle", |params| params.validate().is_ok())
}

/// Coefficients of a published type, each by a factor of its own.
fn any_type(base: FiberType) -> impl Strategy<Value = FiberType> {
    prop::collection::vec(-1.0..1.0_f64, 24).prop_map(move |powers| {
        let mut powers = powers.into_iter();
        // A factor of at most `most`, either way.
        let mut by = |value: &mut f64, most: f64| {
            *value *= most.powf(powers.next().expect("enough factors"));
        };
        let mut t = base;
        by(&mut t.half_force_frequency, 4.0);
        by(&mut t.minimum_frequency, 2.0);
        by(&mut t.maximum_frequency, 2.0);
        by(&mut t.force_length.width, 1.5);
        by(&mut t.force_length.skewness, 1.5);
        by(&mut t.force_length.roundness, 1.5);
        by(&mut t.force_velocity.maximum_velocity, 3.0);
        t.force_velocity.shortening.iter_mut().for_each(|value| by(value, 1.5));
        t.force_velocity.lengthening.iter_mut().for_each(|value| by(value, 1.5));
        by(&mut t.force_velocity.lengthening_velocity, 3.0);
        by(&mut t.activation.scale, 2.0);
        by(&mut t.activation.exponent, 1.5);
        by(&mut t.activation.length_dependence, 1.5);
        by(&mut t.excitation.rise, 4.0);
        by(&mut t.excitation.fall, 4.0);
        by(&mut t.excitation.fall_per_activation, 4.0);
        by(&mut t.effective_length_time, 4.0);
        if let Some(sag) = &mut t.sag {
            by(&mut sag.resting_level, 2.0);
            by(&mut sag.time_constant, 10.0);
        }
        if let Some(yielding) = &mut t.yielding {
            by(&mut yielding.velocity, 10.0);
            by(&mut yielding.time_constant, 4.0);
        }
        t
    })
}

/// Elements of a published set, each coefficient by a factor of its own.
fn any_elements(base: ElementParams) -> impl Strategy<Value = ElementParams> {
    prop::collection::vec(-1.0..1.0_f64, 10).prop_map(move |powers| {
        let mut powers = powers.into_iter();
        let mut by = |value: &mut f64, most: f64| {
            *value *= most.powf(powers.next().expect("enough factors"));
        };
        let mut e = base;
        by(&mut e.tendon.stiffness, 3.0);
        by(&mut e.tendon.toe, 3.0);
        by(&mut e.parallel.stiffness, 3.0);
        by(&mut e.parallel.toe, 2.0);
        by(&mut e.parallel.viscosity, 10.0);
        by(&mut e.compression.strength, 5.0);
        by(&mut e.compression.steepness, 2.0);
        by(&mut e.specific_tension, 2.0);
        e
    })
}

/// Muscles of any size with coefficients far from published ones, as far as they are valid in
/// every arithmetic.
pub fn any_coefficients() -> impl Strategy<Value = MuscleParams<TYPES>> {
    let sets = prop_oneof![
        Just((paper_table_1::ELEMENTS, [paper_table_1::SLOW, paper_table_1::FAST])),
        Just((human_vm4::ELEMENTS, [human_vm4::SUPER_SLOW, human_vm4::FAST])),
        Just((feline_vm4::ELEMENTS, [feline_vm4::SLOW, feline_vm4::FAST])),
    ];
    let types = sets.prop_flat_map(|(elements, [slow, fast])| {
        (any_elements(elements), any_type(slow), any_type(fast))
    });
    (muscles(), types)
        .prop_map(|(muscle, (elements, slow, fast))| {
            let mut params = MuscleParams { elements, ..muscle };
            params.fibers[0].fiber_type = slow;
            params.fibers[1].fiber_type = fast;
            let longest = muscle.maximum_fascicle_length();
            params.max_path_length +=
                (longest - params.maximum_fascicle_length()) * params.fascicle_length;
            params
        })
        .prop_filter("a valid muscle", |params| {
            [TimeStep::SHORTEST, TimeStep::LONGEST].into_iter().all(|seconds| {
                let step = TimeStep::from_seconds(seconds).expect("in range");
                Muscle::<Fixed, IntramuscularFes, TYPES>::build(params, step).is_ok()
            })
        })
}

/// Time steps over the whole allowed range.
pub fn steps() -> impl Strategy<Value = TimeStep> {
    (1e-4..2e-3_f64).prop_map(|seconds| TimeStep::from_seconds(seconds).expect("in range"))
}
