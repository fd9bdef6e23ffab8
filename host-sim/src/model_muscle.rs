//! Converts a muscle in the paper's symbols to the parameters of `vm-nostd`.

use crate::reference::{Elements, Fatigue, FiberType, Muscle};
use vm_nostd as vm;

/// Most fibre types of a muscle on the host; the library has no limit.
pub const MOST_TYPES: usize = 6;

/// A value that `vm-nostd` refuses, with the key and unit of a muscle file.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Index of the fibre type.
    pub fiber: Option<usize>,
    /// Key in the file.
    pub key: String,
    /// Value in the file's unit.
    pub value: String,
    /// What it must be, in the file's unit.
    pub limit: String,
}

/// Calls `$body` with the number of fibre types of `$muscle` as a constant `$n`.
macro_rules! with_type_count {
    ($muscle:expr, $n:ident => $body:expr, else $other:expr) => {
        match $muscle.fibers.len() {
            1 => {
                const $n: usize = 1;
                $body
            }
            2 => {
                const $n: usize = 2;
                $body
            }
            3 => {
                const $n: usize = 3;
                $body
            }
            4 => {
                const $n: usize = 4;
                $body
            }
            5 => {
                const $n: usize = 5;
                $body
            }
            6 => {
                const $n: usize = 6;
                $body
            }
            _ => $other,
        }
    };
}
pub(crate) use with_type_count;

/// Checks that a muscle can be built.
pub fn validate(muscle: &Muscle) -> Result<(), Refusal> {
    with_type_count!(
        muscle,
        N => params::<N>(muscle)
            .validate()
            .and_then(|()| muscle.fatigue.as_ref().map_or(Ok(()), |f| fatigue_params(f).validate()))
            .map_err(refusal),
        else Err(Refusal {
            fiber: None,
            key: "fiber".to_owned(),
            value: format!("{} tables", muscle.fibers.len()),
            limit: format!("a muscle has 1 to {MOST_TYPES} fibre types"),
        })
    )
}

/// Path lengths (m) between which a valid muscle can rest.
pub fn path_domain(muscle: &Muscle) -> (f64, f64) {
    with_type_count!(muscle, N => params::<N>(muscle).path_domain(), else (0.0, 0.0))
}

/// The parameters of a muscle of `N` types.
///
/// # Panics
/// If it has another number of types.
pub fn params<const N: usize>(muscle: &Muscle) -> vm::MuscleParams<N> {
    assert_eq!(muscle.fibers.len(), N, "the number of fibre types");
    vm::MuscleParams {
        mass: muscle.mass,
        fascicle_length: muscle.L_ce0,
        tendon_length: muscle.L_se0,
        max_path_length: muscle.L_mt_max,
        recruitment_saturation: muscle.U_r,
        class: vm::Class::Standard,
        elements: element_params(&muscle.elements),
        fibers: std::array::from_fn(|i| vm::FiberParams {
            fraction: muscle.fibers[i].fraction,
            fiber_type: fiber_type(&muscle.fibers[i].fiber_type),
        }),
    }
}

/// The motor units of a muscle of `N` types.
///
/// # Panics
/// If it has another number of types.
pub fn motor_units<const N: usize, const UNITS: usize>(
    muscle: &Muscle,
) -> Result<vm::MotorUnits<UNITS>, vm::ParameterError> {
    let sizes = std::array::from_fn(|i| vm::UnitSizes::Listed(&muscle.fibers[i].units));
    vm::MotorUnits::new(&params::<N>(muscle), sizes)
}

/// The elements that fibre types share.
pub fn element_params(e: &Elements) -> vm::ElementParams {
    vm::ElementParams {
        tendon: vm::TendonParams { stiffness: e.cT, toe: e.kT, slack_length: e.LrT },
        parallel: vm::ParallelParams {
            stiffness: e.c1,
            toe: e.k1,
            slack_length: e.Lr1,
            viscosity: e.eta,
        },
        compression: vm::CompressionParams { strength: e.c2, steepness: e.k2, onset_length: e.Lr2 },
        specific_tension: e.specific_tension,
        density: e.density,
    }
}

/// Fatigue parameters.
pub fn fatigue_params(f: &Fatigue) -> vm::FatigueParams {
    vm::FatigueParams {
        fatigue_time: f.T_fat,
        recovery_time: f.T_rec,
        least_fitness: f.fit_min,
        frequency_dependence: f.beta,
    }
}

/// A fibre type.
pub fn fiber_type(t: &FiberType) -> vm::FiberType {
    vm::FiberType {
        rank: t.rank,
        half_force_frequency: t.f05,
        minimum_frequency: t.fmin,
        maximum_frequency: t.fmax,
        force_length: vm::ForceLengthParams { width: t.omega, skewness: t.beta, roundness: t.rho },
        force_velocity: vm::ForceVelocityParams {
            maximum_velocity: t.Vmax,
            shortening: [t.cV0, t.cV1],
            lengthening: [t.aV0, t.aV1, t.aV2],
            lengthening_velocity: t.bV,
        },
        activation: vm::ActivationParams { scale: t.af, exponent: t.nf0, length_dependence: t.nf1 },
        excitation: vm::ExcitationParams {
            rise: t.Tf1,
            rise_per_frequency: t.Tf2,
            fall: t.Tf3,
            fall_per_activation: t.Tf4,
        },
        effective_length_time: t.TL,
        sag: t.sag.map(|s| vm::SagParams {
            resting_level: s.aS1,
            firing_level: s.aS2,
            time_constant: s.TS,
        }),
        yielding: t.yielding.map(|y| vm::YieldParams {
            depth: y.cY,
            velocity: y.VY,
            time_constant: y.TY,
        }),
    }
}

/// Field of `vm-nostd`, key of the muscle file, and file units per SI unit.
const KEYS: &[(&str, &str, f64)] = &[
    ("mass", "mass_g", 1e3),
    ("fascicle_length", "fascicle_length_cm", 1e2),
    ("tendon_length", "tendon_length_cm", 1e2),
    ("max_path_length", "max_path_length_cm", 1e2),
    ("recruitment_saturation", "recruitment_saturation", 1.0),
    ("tendon.stiffness", "elements.cT", 1.0),
    ("tendon.toe", "elements.kT", 1.0),
    ("tendon.slack_length", "elements.LrT", 1.0),
    ("parallel.stiffness", "elements.c1", 1.0),
    ("parallel.toe", "elements.k1", 1.0),
    ("parallel.slack_length", "elements.Lr1", 1.0),
    ("parallel.viscosity", "elements.eta", 1.0),
    ("compression.strength", "elements.c2", 1.0),
    ("compression.steepness", "elements.k2", 1.0),
    ("compression.onset_length", "elements.Lr2", 1.0),
    ("specific_tension", "elements.specific_tension_n_per_cm2", 1e-4),
    ("density", "elements.density_g_per_cm3", 1e-3),
    ("fatigue_time", "fatigue.T_fat_s", 1.0),
    ("recovery_time", "fatigue.T_rec_s", 1.0),
    ("least_fitness", "fatigue.fit_min", 1.0),
    ("frequency_dependence", "fatigue.beta", 1.0),
    ("fraction", "fraction", 1.0),
    ("rank", "rank", 1.0),
    ("half_force_frequency", "f05_pps", 1.0),
    ("minimum_frequency", "fmin", 1.0),
    ("maximum_frequency", "fmax", 1.0),
    ("force_length.width", "omega", 1.0),
    ("force_length.skewness", "beta", 1.0),
    ("force_length.roundness", "rho", 1.0),
    ("force_velocity.maximum_velocity", "Vmax", 1.0),
    ("force_velocity.shortening", "cV0, cV1", 1.0),
    ("force_velocity.lengthening", "aV0, aV1, aV2", 1.0),
    ("force_velocity.lengthening_velocity", "bV", 1.0),
    ("activation.scale", "af", 1.0),
    ("activation.exponent", "nf0", 1.0),
    ("activation.length_dependence", "nf1", 1.0),
    ("excitation.rise", "Tf1_ms", 1e3),
    ("excitation.rise_per_frequency", "Tf2_ms", 1e3),
    ("excitation.fall", "Tf3_ms", 1e3),
    ("excitation.fall_per_activation", "Tf4_ms", 1e3),
    ("effective_length_time", "TL_ms", 1e3),
    ("sag.resting_level", "aS1", 1.0),
    ("sag.firing_level", "aS2", 1.0),
    ("sag.time_constant", "TS_ms", 1e3),
    ("yielding.depth", "cY", 1.0),
    ("yielding.velocity", "VY", 1.0),
    ("yielding.time_constant", "TY_ms", 1e3),
];

/// A number in the file's unit, without the rounding noise of the conversion.
pub(crate) fn in_file_unit(value: f64, scale: f64) -> f64 {
    format!("{:.9e}", value * scale).parse().unwrap_or(value * scale)
}

fn refusal(error: vm::ParameterError) -> Refusal {
    // A derived quantity follows the field after a colon.
    let (field, derived) =
        error.field.split_once(": ").map_or((error.field, None), |(f, d)| (f, Some(d)));
    let (key, scale) = KEYS
        .iter()
        .find(|(name, ..)| *name == field)
        .map_or((field, 1.0), |&(_, key, scale)| (key, scale));
    // It has its own unit.
    let scale = if derived.is_some() { 1.0 } else { scale };
    let key = derived.map_or(key.to_owned(), |derived| format!("{key}: {derived}"));
    let limit = match error.limit {
        vm::Limit::Within { least, most } => {
            vm::Limit::Within { least: in_file_unit(least, scale), most: in_file_unit(most, scale) }
        }
        other => other,
    };
    Refusal {
        fiber: error.fiber,
        key,
        value: in_file_unit(error.value, scale).to_string(),
        limit: limit.to_string(),
    }
}
