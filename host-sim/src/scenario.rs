//! Scenarios for comparing the arithmetics: the authors' traces, and more demanding inputs.

use crate::coefficients;
use crate::muscle_file;
use crate::reference::{Fatigue, Fiber, Input, Mode, Muscle, UnitSizes};
use crate::trace::{self, InputTrace};
use std::f64::consts::TAU;
use std::path::Path;
use vm_nostd::Status;

/// A muscle, a mode and inputs.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Name, with the time step if that is not 1 ms.
    pub name: String,
    /// The muscle.
    pub muscle: Muscle,
    /// The recruitment mode.
    pub mode: Mode,
    /// The inputs.
    pub trace: InputTrace,
    /// Tendon force of the authors' program at every row, N.
    pub vector: Option<Vec<f64>>,
    /// Exactly the flags that `vm-nostd` must raise.
    pub flags: Status,
}

/// The paper's validation muscle, "deltoid posterior".
pub fn paper_muscle() -> Muscle {
    Muscle {
        mass: 97.5e-3,
        L_ce0: 0.11,
        L_se0: 0.02,
        L_mt_max: 0.184,
        U_r: 0.8,
        elements: coefficients::elements(coefficients::DEFAULT_SET).expect("the default set"),
        fibers: vec![preset("paper-table-1/slow", 0.6), preset("paper-table-1/fast", 0.4)],
        fatigue: None,
    }
}

/// The same muscle with `count` motor units per type, of the authors' default sizes.
pub fn paper_muscle_of_units(count: usize) -> Muscle {
    let mut muscle = paper_muscle();
    for fiber in &mut muscle.fibers {
        fiber.units = UnitSizes::Default.shares(fiber.fiber_type.rank, count);
    }
    muscle
}

/// A small human hand muscle with all three fibre types and a long tendon: 4 g, 3.2 cm of
/// fascicle, 6 cm of tendon.
fn hand_muscle() -> Muscle {
    Muscle {
        mass: 4e-3,
        L_ce0: 0.032,
        L_se0: 0.06,
        L_mt_max: 0.106,
        U_r: 0.6,
        elements: coefficients::elements("human-vm4").expect("a published set"),
        fibers: vec![
            preset("human-vm4/super-slow", 0.2),
            preset("human-vm4/slow", 0.45),
            preset("human-vm4/fast", 0.35),
        ],
        fatigue: None,
    }
}

/// A feline muscle of one fast type.
fn feline_muscle() -> Muscle {
    Muscle {
        mass: 10e-3,
        L_ce0: 0.025,
        L_se0: 0.05,
        L_mt_max: 0.086,
        U_r: 0.8,
        elements: coefficients::elements("feline-vm4").expect("a published set"),
        fibers: vec![preset("feline-vm4/fast", 1.0)],
        fatigue: None,
    }
}

fn preset(name: &str, fraction: f64) -> Fiber {
    coefficients::fiber(name, fraction).expect("a published preset")
}

/// The paper's muscle with the fatigue of a paralysed quadriceps.
fn tiring_muscle() -> Muscle {
    let fatigue = Fatigue { T_fat: 18.0, T_rec: 30.0, fit_min: 0.0, beta: 0.6 };
    Muscle { fatigue: Some(fatigue), ..paper_muscle() }
}

/// One of the vectors in `host-sim/data/vectors`.
struct Vector {
    name: &'static str,
    mode: Mode,
    /// Motor units per type, in a discrete mode.
    units: usize,
    /// Muscle file; `None` for the paper's muscle.
    muscle: Option<&'static str>,
    text: &'static str,
}

macro_rules! vector {
    ($name:literal, $mode:ident, $units:literal) => {
        Vector {
            name: $name,
            mode: Mode::$mode,
            units: $units,
            muscle: None,
            text: include_str!(concat!("../data/vectors/", $name, ".csv")),
        }
    };
    ($name:literal, $mode:ident of a muscle file) => {
        Vector {
            muscle: Some(include_str!(concat!("../data/vectors/", $name, ".toml"))),
            ..vector!($name, $mode, 0)
        }
    };
}

const VECTORS: &[Vector] = &[
    vector!("continuous_activation_3hz", Continuous, 0),
    vector!("continuous_length_3hz", Continuous, 0),
    vector!("continuous_steps", Continuous, 0),
    vector!("passive_length_3hz", Continuous, 0),
    vector!("fes_ramp_20hz", Fes, 0),
    vector!("fes_steps", Fes, 0),
    vector!("discrete_3_activation_3hz", Discrete, 3),
    vector!("discrete_30_length_3hz", Discrete, 30),
    vector!("soleus_gait", Continuous of a muscle file),
    vector!("passive_cyclic", Continuous of a muscle file),
    vector!("fast_ramps_kinks", Continuous of a muscle file),
    vector!("fes_variable_trains", Fes of a muscle file),
    vector!("fes_doublets", Fes of a muscle file),
    vector!("leff_hand_length_chirp", DiscreteEffectiveLength of a muscle file),
    vector!("yield_fes_frequency_ramp_cat", Fes of a muscle file),
    vector!("yield_fes_frequency_ramp_deltoid", Fes of a muscle file),
    vector!("yield_fes_frequency_every_10ms_cat", Fes of a muscle file),
    vector!("yield_path_quantised_0_1mm", Continuous of a muscle file),
];

/// Path length of the paper's figures, m.
const PATH: f64 = 0.16;
/// Frequencies of the sinusoids, Hz.
const FREQUENCIES: [u32; 4] = [1, 3, 5, 10];

/// Every scenario at 1 ms and 0.5 ms; the vectors also at the longest and shortest step.
pub fn all() -> Vec<Scenario> {
    let mut scenarios: Vec<Scenario> = VECTORS.iter().map(vector).collect();
    // There is no vector with effective length: compared with the reference only.
    let discrete = scenarios.iter().filter(|scenario| scenario.mode == Mode::Discrete);
    let mode = Mode::DiscreteEffectiveLength;
    let effective: Vec<Scenario> =
        discrete.map(|scenario| Scenario { mode, vector: None, ..scenario.clone() }).collect();
    scenarios.extend(effective);
    let vector_count = scenarios.len();
    for mode in [Mode::Continuous, Mode::Fes] {
        for hz in FREQUENCIES {
            scenarios.push(generated(
                &format!("activation_{hz}hz"),
                paper_muscle(),
                mode,
                2.0,
                |t| [0.5 - 0.5 * libm::cos(TAU * f64::from(hz) * t), PATH, 30.0],
            ));
            // Up to 3.4 L_ce0/s, from a standstill.
            let amplitude = 0.02_f64.min(0.06 / f64::from(hz));
            scenarios.push(generated(&format!("length_{hz}hz"), paper_muscle(), mode, 2.0, |t| {
                let swing = libm::sin(TAU * f64::from(hz) * t) * smooth(t / 0.3);
                [0.6, PATH + amplitude * swing, 20.0]
            }));
        }
        scenarios.push(generated("fast_stretch", paper_muscle(), mode, 1.5, |t| {
            // 14 to 18 cm at up to 6 L_ce0/s, and back slowly, so that the tendon stays taut.
            let stretch = smooth((t - 0.5) / 0.11) - smooth((t - 1.0) / 0.4);
            [0.7, 0.14 + 0.04 * stretch, 25.0]
        }));
        scenarios.push(generated("velocity_kinks", paper_muscle(), mode, 1.5, |t| {
            // Every 0.25 s the path starts at 4.6 L_ce0/s or stops within a tick.
            let moving = t.rem_euclid(0.5) < 0.25;
            let swing = if moving { libm::sin(TAU * 10.0 * t) } else { 0.0 };
            [0.5, PATH + 0.008 * swing, 30.0]
        }));
        scenarios.push(generated("frequency_sweep", paper_muscle(), mode, 2.0, |t| {
            [0.2 + 0.7 * smooth((t - 0.2) / 0.4), PATH, 2.0 + 40.0 * smooth((t - 0.3) / 1.5)]
        }));
        let on_off = generated("on_off_hand", hand_muscle(), mode, 2.5, |t| {
            let activation = [0.0, 0.2, 0.6, 0.1, 0.4, 0.0][((t / 0.4) as usize).min(5)];
            [activation, 0.1 + 0.004 * libm::sin(TAU * 2.0 * t) * smooth(t / 0.5), 35.0]
        });
        // FES also recruits the super-slow fibres while the tendon is almost slack: the muscle
        // briefly shortens faster than their V_max.
        let flags = match mode {
            Mode::Fes => Status::FASCICLE_OUTSIDE_DOMAIN,
            _ => Status::empty(),
        };
        scenarios.push(Scenario { flags, ..on_off });
        scenarios.push(generated("fatigue", tiring_muscle(), mode, 12.0, |t| {
            // Two long contractions with a pause; the second has a higher frequency.
            let on = smooth(t / 0.3) - smooth((t - 5.0) / 0.5) + 0.6 * smooth((t - 8.0) / 0.3);
            [on.max(0.0), PATH, 20.0 + 30.0 * smooth((t - 8.0) / 0.5)]
        }));
        scenarios.push(generated("walk_feline", feline_muscle(), mode, 2.0, |t| {
            // Exactly 0 when off: a sine's rounding residue would count as stimulated under FES and
            // is below the fixed-point ULP.
            let sine = libm::sin(TAU * 2.0 * t);
            let step = if sine > 1e-9 { sine } else { 0.0 };
            [0.9 * step, 0.074 + 0.008 * libm::cos(TAU * 2.0 * t) * smooth(t / 0.4), 40.0]
        }));
    }
    let vectors = &scenarios[..vector_count];
    let mut others: Vec<Scenario> = scenarios.iter().map(|s| resampled(s, "0.5ms", 1, 2)).collect();
    others.extend(vectors.iter().map(|s| resampled(s, "0.1ms", 1, 10)));
    others.extend(scenarios.iter().map(|s| resampled(s, "2ms", 2, 1)));
    scenarios.extend(others);
    scenarios
}

/// Smooth step from 0 to 1 for `x` from 0 to 1, without a jump of velocity or acceleration.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

fn vector(&Vector { name, mode, units, muscle, text }: &Vector) -> Scenario {
    let path = Path::new(name);
    let muscle = match muscle {
        Some(file) => muscle_file::parse(file, path).expect("a built-in muscle").muscle,
        None if units > 0 => paper_muscle_of_units(units),
        None => paper_muscle(),
    };
    let trace = trace::parse_inputs(text.as_bytes(), path).expect("a built-in vector");
    let mut columns = trace::INPUT_COLUMNS.to_vec();
    columns.push("force_n");
    let rows = trace::numbers(text.as_bytes(), path, &columns).expect("a built-in vector");
    Scenario {
        name: name.to_owned(),
        muscle,
        mode,
        trace,
        vector: Some(rows.iter().map(|(_, row)| row[4]).collect()),
        flags: Status::empty(),
    }
}

/// A scenario of activation, path length (m) and stimulation frequency (pps) over time.
fn generated(
    name: &str,
    muscle: Muscle,
    mode: Mode,
    duration: f64,
    at: impl Fn(f64) -> [f64; 3],
) -> Scenario {
    let time_step = 1e-3;
    let ticks = (duration / time_step).round() as usize;
    let inputs = (0..=ticks)
        .map(|tick| {
            let [activation, path_length, stimulation_frequency] = at(tick as f64 * time_step);
            Input { activation, path_length, stimulation_frequency }
        })
        .collect();
    let trace = InputTrace { start: 0.0, time_step, inputs };
    Scenario { name: name.to_owned(), muscle, mode, trace, vector: None, flags: Status::empty() }
}

/// The same scenario at another time step: every `stride`-th input, refined by `factor`.
fn resampled(scenario: &Scenario, step: &str, stride: usize, factor: usize) -> Scenario {
    Scenario {
        name: format!("{}@{step}", scenario.name),
        trace: scenario.trace.strided(stride).refined(factor),
        vector: None,
        ..scenario.clone()
    }
}
