//! Golden bits of every mode, arithmetic and kind of muscle.
//!
//! `golden.toml` of host-sim holds the bits of the published scenarios. These tests do not need
//! host-sim and cover what those do not: jumping paths, NaN inputs and other time steps.
//! `VM_WRITE=1 cargo test --release -p model-tests --test bits` writes the bits; without `VM_WRITE`
//! they are compared.

use model_tests::muscles::{Discrete, Mode, built};
use std::fmt::Write;
use std::path::Path;
use vm_nostd::{
    Class, EffectiveLength, FascicleLength, FiberParams, Fixed, Input, IntramuscularFes,
    MuscleParams, NaturalContinuous, Scalar, TimeStep, feline_vm4, human_vm4,
};
use vm_nostd_cores::{Inputs, MUSCLE, Scenario};

/// Ticks of each run: several steps of activation and frequency, and invalid inputs.
const TICKS: u32 = 3_000;

/// A muscle of human fibre types with a long tendon.
const LONG_TENDON: MuscleParams<2> = MuscleParams {
    mass: 0.02,
    fascicle_length: 0.06,
    tendon_length: 0.17,
    max_path_length: 0.253,
    recruitment_saturation: 1.0,
    class: Class::Standard,
    elements: human_vm4::ELEMENTS,
    fibers: [
        FiberParams { fraction: 0.7, fiber_type: human_vm4::SUPER_SLOW },
        FiberParams { fraction: 0.3, fiber_type: human_vm4::FAST },
    ],
};

/// A light muscle of feline fibre types.
const FELINE: MuscleParams<2> = MuscleParams {
    mass: 0.01,
    fascicle_length: 0.04,
    tendon_length: 0.05,
    max_path_length: 0.102,
    recruitment_saturation: 0.6,
    class: Class::Standard,
    elements: feline_vm4::ELEMENTS,
    fibers: [
        FiberParams { fraction: 0.4, fiber_type: feline_vm4::SLOW },
        FiberParams { fraction: 0.6, fiber_type: feline_vm4::FAST },
    ],
};

/// FNV-1a checksum of words.
struct Sum(u64);

impl Sum {
    fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

/// Checksum of all states and outputs of a run.
fn bits<S: Scalar, R: Mode<S>>(params: &MuscleParams<2>, seconds: f64, natural: usize) -> u64 {
    let step = TimeStep::from_seconds(seconds).expect("a step");
    let muscle = built::<S, R>(params, step);
    let (shortest, longest) = params.path_domain();
    let mut state = muscle.rest(S::path_length(0.5 * (shortest + longest))).expect("in range");
    let mut sum = Sum(0xcbf2_9ce4_8422_2325);
    for tick in 0..TICKS {
        let input: Input<f64> = Scenario.inputs(tick)[natural];
        // The scenario's path is that of the paper's muscle, 0.12 to 0.2 m; scaled to the range of
        // this muscle and beyond.
        let share = (input.path_length - 0.13) / 0.06;
        let jump = if tick % 700 < 350 { 0.0 } else { 0.1 };
        let path = shortest + (share + jump) * (longest - shortest);
        let input = Input {
            activation: S::from_f64(input.activation),
            path_length: S::path_length(path),
            stimulation_frequency: S::quantity(input.stimulation_frequency),
        };
        let output = muscle.step(&mut state, input);
        state.words().for_each(|word| sum.add(word.into()));
        sum.add(S::force_bits(output.force).into());
        sum.add(output.fascicle_length.to_bits().into());
        sum.add(output.fascicle_velocity.to_bits().into());
        sum.add(output.status.bits().into());
    }
    sum.0
}

fn rows<S: Scalar>(arithmetic: &str) -> String {
    let mut text = String::new();
    for (name, params) in [("paper", MUSCLE), ("long tendon", LONG_TENDON), ("feline", FELINE)] {
        for seconds in [1e-3, 0.4e-3, 2e-3] {
            let rows = [
                ("continuous", bits::<S, NaturalContinuous>(&params, seconds, 0)),
                ("fes", bits::<S, IntramuscularFes>(&params, seconds, 1)),
                ("discrete", bits::<S, Discrete<FascicleLength>>(&params, seconds, 0)),
                ("discrete-leff", bits::<S, Discrete<EffectiveLength>>(&params, seconds, 0)),
            ];
            for (mode, sum) in rows {
                writeln!(text, "{name}, {mode}, {arithmetic}, {} us: {sum:016x}", seconds * 1e6)
                    .expect("a text");
            }
        }
    }
    text
}

#[test]
fn all_bits_are_unchanged() {
    let found = [rows::<f32>("f32"), rows::<f64>("f64"), rows::<Fixed>("fixed")].concat();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("bits.txt");
    if std::env::var_os("VM_WRITE").is_some() {
        std::fs::write(&path, &found).expect("a file");
    }
    let kept = std::fs::read_to_string(&path).expect("tests/model/bits.txt");
    for (kept, found) in kept.lines().zip(found.lines()) {
        assert_eq!(kept, found, "VM_WRITE=1 cargo test --release -p model-tests --test bits");
    }
    assert_eq!(kept.lines().count(), found.lines().count());
}
