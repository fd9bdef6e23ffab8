//! Tests that in fixed point no sum or product saturates in a tick without flags: published
//! muscles, inputs over their whole validity range, at up to 5 L_ce0/s.
//!
//! A product with a constant may saturate: softplus and exp have reached their limits then, far
//! from a slack tendon and at speeds far from V_Y. A tendon beyond its range is flagged.

use crate::recruitment::{
    EffectiveLength, IntramuscularFes, MotorUnits, NaturalContinuous, NaturalDiscrete, Recruitment,
    UnitSizes,
};
use crate::scalar::Scalar;
use crate::scalar::fixed::{Fixed, saturations};
use crate::{
    ElementParams, FiberParams, FiberType, Input, Muscle, MuscleParams, Status, TimeStep,
    feline_vm4, human_vm4, paper_table_1,
};

/// Reproducible pseudo-random numbers, 0 to 1.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 40) as f64 / (1 << 24) as f64
    }
}

fn muscles() -> Vec<MuscleParams<2>> {
    let sets: [(ElementParams, [FiberType; 2]); 7] = [
        (paper_table_1::ELEMENTS, [paper_table_1::SLOW, paper_table_1::FAST]),
        (human_vm4::ELEMENTS, [human_vm4::SUPER_SLOW, human_vm4::FAST]),
        (human_vm4::ELEMENTS, [human_vm4::SLOW, human_vm4::FAST]),
        (feline_vm4::ELEMENTS, [feline_vm4::SLOW, feline_vm4::FAST]),
        // Single types: without a fast type the validity range includes shorter fascicles, with
        // more compression of the filaments.
        (human_vm4::ELEMENTS, [human_vm4::SLOW; 2]),
        (feline_vm4::ELEMENTS, [feline_vm4::SUPER_SLOW; 2]),
        (feline_vm4::ELEMENTS, [feline_vm4::SLOW; 2]),
    ];
    // Mass (kg), fascicle and tendon length (m) of a shoulder, hand, calf and neck muscle, and the
    // extremes of published morphometry.
    let sizes = [
        (0.0975, 0.11, 0.02),
        (4e-3, 0.032, 0.06),
        (0.3, 0.05, 0.25),
        (0.02, 0.08, 0.04),
        (0.05, 0.05, 0.6),
        (20.0, 0.5, 0.025),
        (0.5, 0.5, 2.0),
        (1e-4, 0.015, 0.00075),
    ];
    let all = sets.into_iter().flat_map(|set| sizes.map(|size| (set, size)));
    all.map(|((elements, [slow, fast]), (mass, fascicle_length, tendon_length))| MuscleParams {
        mass,
        fascicle_length,
        tendon_length,
        max_path_length: 1.4 * fascicle_length + tendon_length,
        recruitment_saturation: 0.8,
        class: crate::Class::Standard,
        elements,
        fibers: [
            FiberParams { fraction: 0.6, fiber_type: slow },
            FiberParams { fraction: 0.4, fiber_type: fast },
        ],
    })
    .collect()
}

/// Ticks that saturated without a flag, and ticks without a flag.
fn unflagged<R: Recruitment<Fixed, 2>>(params: &MuscleParams<2>, units: &R::Units) -> (u32, u32) {
    let step = TimeStep::MILLISECOND;
    let muscle = Muscle::<Fixed, R, 2>::build_with_units(params, units, step).expect("valid");
    let (shortest, longest) = params.path_domain();
    let mut path = shortest + 0.7 * (longest - shortest);
    let mut state = muscle.rest(Fixed::path_length(path)).expect("in range");
    let mut chance = Chance(7);
    let (mut saturated, mut ticks) = (0, 0);
    for _ in 0..60 {
        let goal = shortest + chance.next() * (longest - shortest);
        let stride = 5e-3 * params.fascicle_length * chance.next();
        let (activation, frequency) = (chance.next(), 500.0 * chance.next());
        for _ in 0..100 {
            path += (goal - path).clamp(-stride, stride);
            let input = Input {
                activation: Fixed::from_f64(activation),
                path_length: Fixed::path_length(path),
                stimulation_frequency: <Fixed as Scalar>::quantity(frequency),
            };
            saturations::take();
            let output = muscle.step(&mut state, input);
            let silent = output.status == Status::empty();
            ticks += u32::from(silent);
            saturated += u32::from(silent && saturations::take() > 0);
        }
    }
    (saturated, ticks)
}

#[test]
fn nothing_saturates_in_a_tick_without_a_flag() {
    for (index, params) in muscles().iter().enumerate() {
        let units = MotorUnits::<6>::new(params, [UnitSizes::Default(3); 2]).expect("valid");
        let found = [
            unflagged::<NaturalContinuous>(params, &()),
            unflagged::<IntramuscularFes>(params, &()),
            unflagged::<NaturalDiscrete<EffectiveLength, 6>>(params, &units),
        ];
        for (mode, (saturated, silent)) in found.into_iter().enumerate() {
            assert!(saturated == 0, "muscle {index}, mode {mode}: {saturated} of {silent} ticks");
            // Of 6,000. On the longest paths passive fascicles are outside the validity range and
            // flagged.
            assert!(
                silent > 2000,
                "muscle {index}, mode {mode}: only {silent} ticks without a flag"
            );
        }
    }
}

#[test]
fn saturated_sums_and_products_are_counted() {
    let large = Fixed::from_f64(100.0);
    saturations::take();
    let _ = [large + large, large * large, -large - large, large * Fixed::from_f64(1.2)];
    assert_eq!(saturations::take(), 3);
}
