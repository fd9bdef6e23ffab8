//! The longest path of the muscle's parameters scales the parallel elastic element but does not
//! limit paths: they are accepted to the end of the validity range.

use host_sim::engine::{self, Arithmetic};
use host_sim::metrics::{ForceError, forces};
use host_sim::model_muscle;
use host_sim::reference::{Input, Mode, Muscle};
use host_sim::scenario::paper_muscle;
use host_sim::trace::InputTrace;
use vm_nostd::{ContinuousMuscle, Fixed, Scalar, Status, TimeStep};
use vm_nostd_cores::MUSCLE;

/// Largest error (% of F0) and flags of an arithmetic against the reference.
fn error(muscle: &Muscle, mode: Mode, arithmetic: Arithmetic, trace: &InputTrace) -> (f64, Status) {
    let run = |arithmetic| engine::run(muscle, mode, arithmetic, trace).expect("a run");
    let (rows, reference) = (run(arithmetic), run(Arithmetic::Reference));
    let flags = rows.iter().fold(Status::empty(), |all, row| all | row.1);
    let of = |rows: &[engine::Row]| forces(rows.iter().map(|row| &row.0));
    (ForceError::between(&of(&rows), &of(&reference), muscle.f0()).max, flags)
}

fn inputs(at: impl Fn(f64) -> [f64; 3]) -> InputTrace {
    let inputs = (0..=1500)
        .map(|tick| {
            let [activation, path_length, stimulation_frequency] = at(f64::from(tick) * 1e-3);
            Input { activation, path_length, stimulation_frequency }
        })
        .collect();
    InputTrace { start: 0.0, time_step: 1e-3, inputs }
}

/// Smooth step from 0 to 1.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

#[test]
fn a_path_beyond_the_longest_is_as_accurate() {
    let muscle = paper_muscle();
    for beyond in [1e-3, 5e-3, 1e-2] {
        for mode in [Mode::Continuous, Mode::Fes] {
            // Held beyond it, and stretched beyond it while active.
            let there = muscle.L_mt_max + beyond;
            let traces = [
                inputs(|t| [0.8 * smooth(t / 0.5), there, 25.0]),
                inputs(|t| [0.6, 0.17 + (there - 0.17) * smooth(t / 0.8), 25.0]),
            ];
            for trace in traces {
                for arithmetic in [Arithmetic::F32, Arithmetic::Fixed] {
                    let (error, flags) = error(&muscle, mode, arithmetic, &trace);
                    assert!(error <= 0.05, "{beyond} m, {mode:?}, {arithmetic:?}: {error} % F0");
                    assert_eq!(flags, Status::empty(), "{beyond} m, {mode:?}, {arithmetic:?}");
                }
            }
        }
    }
}

#[test]
fn fes_on_a_path_longer_than_the_longest() {
    // Start of the example in the authors' manual, p. 51, with a muscle of such a path.
    let longest =
        Muscle { mass: 0.25, L_ce0: 0.134, L_se0: 0.143, L_mt_max: 0.329, ..paper_muscle() };
    let trace =
        inputs(|t| [if t > 0.2 { 0.7 } else { 0.0 }, 0.333 - 0.03 * smooth((t - 0.5) / 0.5), 20.0]);
    for arithmetic in [Arithmetic::F32, Arithmetic::Fixed] {
        let (error, flags) = error(&longest, Mode::Fes, arithmetic, &trace);
        assert!(error <= 0.1, "{arithmetic:?}: {error} % F0");
        assert_eq!(flags, Status::empty(), "{arithmetic:?}");
    }
}

#[test]
fn the_validity_range_ends_where_n_f_is_undefined_at_any_activation() {
    let muscle = paper_muscle();
    let (_, longest) = model_muscle::path_domain(&muscle);
    assert!(longest > muscle.L_mt_max + 0.01, "{longest}");
    let (_, most) = MUSCLE.fascicle_domain();
    // At rest the fascicles are beyond it, which is flagged; passive forces are always valid.
    let trace = inputs(|t| [0.0, 0.18 + (longest - 1e-6 - 0.18) * smooth(t / 1.2), 20.0]);
    for arithmetic in [Arithmetic::F32, Arithmetic::Fixed] {
        let (error, flags) = error(&muscle, Mode::Continuous, arithmetic, &trace);
        assert!(error <= 0.05, "{arithmetic:?}: {error} % F0");
        assert_eq!(flags, Status::FASCICLE_OUTSIDE_DOMAIN, "{arithmetic:?}");
    }
    // On a longer path no force of F0 keeps them inside.
    let e = &muscle.elements;
    let l_max = muscle.maximum_fascicle_length();
    let passive = e.c1 * e.k1 * ((most / l_max - e.Lr1) / e.k1).exp().ln_1p();
    let tendon = e.LrT + e.kT * (((1.0 + passive) / (e.cT * e.kT)).exp() - 1.0).ln();
    let expected = most * muscle.L_ce0 + tendon * muscle.L_se0;
    assert!((longest - expected).abs() < 1e-9, "{longest} {expected}");
}

fn clips_at_the_end<S: Scalar>() {
    let muscle = ContinuousMuscle::<S, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("valid");
    let (shortest, longest) = muscle.path_length_range();
    let (at_least, at_most) = MUSCLE.path_domain();
    assert!((S::path_metres(longest) - at_most).abs() < 1e-7);
    assert!((S::path_metres(shortest) - at_least).abs() < 1e-7);
    let flagged = |path: f64| {
        let mut state = muscle.rest(longest).expect("in range");
        let input = vm_nostd::Input {
            activation: S::from_f64(0.5),
            path_length: S::path_length(path),
            stimulation_frequency: S::quantity(0.0),
        };
        muscle.step(&mut state, input).status.contains(Status::PATH_LENGTH_CLIPPED)
    };
    assert!(flagged(at_most + 1e-4) && !flagged(at_most - 1e-4));
    assert!(flagged(at_least - 1e-4) && !flagged(at_least + 1e-4));
    assert!(muscle.rest(S::path_length(at_most + 1e-4)).is_err());
}

#[test]
fn paths_are_clipped_and_flagged_at_the_ends_of_the_validity_range() {
    clips_at_the_end::<f32>();
    clips_at_the_end::<f64>();
    clips_at_the_end::<Fixed>();
}
