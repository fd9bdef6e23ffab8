//! What fixed point refuses: numbers in F0 and L_ce0 beyond 60, and sums of two beyond 120. Each
//! limit from both sides, a hundredth away from it.

use vm_nostd::{FesMuscle, Fixed, MuscleParams, TimeStep};
use vm_nostd_cores::MUSCLE;

type Params = MuscleParams<2>;

/// The paper's muscle with a change; its longest path gives the passive fascicles `longest` L_ce0.
fn changed(longest: f64, change: impl FnOnce(&mut Params)) -> Params {
    let mut params = MUSCLE;
    change(&mut params);
    params.max_path_length += (longest - params.maximum_fascicle_length()) * params.fascicle_length;
    FesMuscle::<f64, 2>::build(&params, TimeStep::MILLISECOND).expect("f64 takes it");
    params
}

/// What fixed point refuses, if anything: name and value.
fn refused(params: &Params) -> Option<(&'static str, f64)> {
    let error = FesMuscle::<Fixed, 2>::build(params, TimeStep::MILLISECOND).err()?;
    Some((error.field, error.value))
}

/// Whether this is what it refuses.
fn is_refused(params: &Params, name: &str) -> bool {
    refused(params).is_some_and(|(field, _)| field.starts_with(name))
}

#[test]
fn a_tendon_is_stiff_to_6000_f0_per_optimal_length() {
    // 27.8 F0 per tendon length of which 0.11 m have so many.
    let of = |stiffness: f64| changed(1.2, |p| p.tendon_length = 27.8 * 0.11 / stiffness);
    assert!(!is_refused(&of(5_950.0), "tendon.stiffness"));
    assert!(is_refused(&of(6_050.0), "tendon.stiffness"));
}

#[test]
fn a_tendons_toe_carries_a_twelfth_of_f0() {
    let of = |toe_force: f64| {
        changed(1.2, |p| {
            (p.elements.tendon.stiffness, p.elements.tendon.toe) = (8.0, toe_force / 8.0)
        })
    };
    assert!(!is_refused(&of(1.01 / 12.0), "tendon.toe"));
    assert!(is_refused(&of(0.99 / 12.0), "tendon.toe"));
}

#[test]
fn a_stimulus_of_500_pps_is_120_half_force_frequencies() {
    let of = |pps: f64| changed(1.2, |p| p.fibers[0].fiber_type.half_force_frequency = pps);
    assert!(!is_refused(&of(500.0 / 119.0), "half_force_frequency"));
    assert!(is_refused(&of(500.0 / 121.0), "half_force_frequency"));
}

/// A tendon so long and soft that the passive muscle stretches it by many fascicles.
#[test]
fn a_path_ranges_over_60_optimal_lengths() {
    let of = |fascicles: f64| {
        changed(1.2, |p| {
            let (tendon, parallel) = (&mut p.elements.tendon, &mut p.elements.parallel);
            (tendon.stiffness, tendon.toe) = (5.0, 0.02);
            (parallel.stiffness, parallel.slack_length, parallel.toe) = (100.0, 0.8, 0.046);
            p.fascicle_length = 0.05;
            p.tendon_length = fascicles * p.fascicle_length;
        })
    };
    // The passive force is 100 · 0.046 · ln(exp(0.2 / 0.046) + 1) = 20.06 F0: beyond its toe a
    // tendon of 5 F0 stretches to 4.012 of its lengths more than its slack one.
    let of_path = |range: f64| {
        let (shortest, _) = of(1.0).fascicle_domain();
        of((range - 1.2 + shortest) / 4.012)
    };
    assert!(!is_refused(&of_path(59.4), "max_path_length: range"));
    assert!(is_refused(&of_path(60.6), "max_path_length: range"));
}

/// A path that would be longer is cut there, and not refused.
#[test]
fn the_path_of_a_soft_tendon_ends_after_60_optimal_lengths() {
    let params = changed(1.2, |p| {
        let (tendon, parallel) = (&mut p.elements.tendon, &mut p.elements.parallel);
        (tendon.stiffness, tendon.toe) = (3.0, 0.03);
        (parallel.stiffness, parallel.slack_length, parallel.toe) = (10.0, 0.8, 0.046);
        (p.fascicle_length, p.tendon_length) = (0.02, 0.75);
    });
    let (shortest, longest) = params.path_domain();
    assert!(longest - shortest > 60.0 * 0.02, "{shortest} {longest}");
    let muscle = FesMuscle::<Fixed, 2>::build(&params, TimeStep::MILLISECOND).expect("valid");
    let (least, most) = muscle.path_length_range();
    let range = f64::from(most - least) * 1e-6 / 0.02;
    assert!((range - 60.0).abs() < 1e-3, "{range}");
}

/// Of a muscle that rests on its longest path, in `f64`: its fascicles and a quarter more, but no
/// more than the path, over those of the passive muscle on `max_path_length`.
fn stretch(params: &Params) -> f64 {
    let muscle = FesMuscle::<f64, 2>::build(params, TimeStep::MILLISECOND).expect("f64 takes it");
    let (_, longest) = muscle.path_length_range();
    let state = muscle.rest(longest).expect("the longest path");
    let fascicles = muscle.observe(&state).fascicle_length + 0.25;
    fascicles.min(longest / params.fascicle_length) / params.maximum_fascicle_length()
}

/// With a tendon that ends them, and with a longer one.
#[test]
fn the_longest_fascicles_pull_with_60_f0() {
    for tendon_length in [0.02, 0.1] {
        let mut seen = [0; 2];
        for stiffness in (20..=200).step_by(2).map(f64::from) {
            let params = changed(0.801, |p| {
                p.tendon_length = tendon_length;
                p.elements.parallel.stiffness = stiffness;
            });
            // Far beyond the toe.
            let slack = params.elements.parallel.slack_length;
            let force = stiffness * (stretch(&params) - slack);
            if (force - 60.0).abs() < 0.6 {
                continue;
            }
            let is_refused = is_refused(&params, "parallel.stiffness: force");
            assert_eq!(is_refused, force > 60.0, "{stiffness}: {force} {:?}", refused(&params));
            seen[usize::from(is_refused)] += 1;
        }
        assert!(seen.iter().all(|count| *count > 5), "{seen:?}");
    }
}

#[test]
fn the_longest_fascicles_are_120_toes_beyond_their_slack() {
    let mut seen = [0; 2];
    for slack in (80..=150).map(|hundredths| f64::from(hundredths) * 0.01) {
        let params = changed(0.801, |p| {
            (p.elements.parallel.stiffness, p.elements.parallel.toe) = (1.0, 0.01);
            p.elements.parallel.slack_length = slack;
        });
        let toes = (stretch(&params) - slack) / 0.01;
        if (toes - 120.0).abs() < 0.6 {
            continue;
        }
        let is_refused = is_refused(&params, "parallel.toe: longest");
        assert_eq!(is_refused, toes > 120.0, "{slack}: {toes} {:?}", refused(&params));
        seen[usize::from(is_refused)] += 1;
    }
    assert!(seen.iter().all(|count| *count > 5), "{seen:?}");
}

/// At the shortest length, and half a tick of 60 L_ce0/s before it by the slope there: 120 F0.
#[test]
fn the_filaments_push_with_120_f0_half_a_tick_ahead() {
    let of = |ahead: f64| {
        changed(1.2, |p| {
            let (shortest, _) = p.fascicle_domain();
            let compression = &mut p.elements.compression;
            compression.steepness = -30.0;
            let growth = (-30.0 * (shortest - compression.onset_length)).exp() - 1.0;
            // 0.03 L_ce0 at 30 per L_ce0 add 0.9 of the force.
            compression.strength = -ahead / 1.9 / growth;
        })
    };
    assert!(!is_refused(&of(118.8), "compression.strength"));
    assert!(is_refused(&of(121.2), "compression.strength"));
}
