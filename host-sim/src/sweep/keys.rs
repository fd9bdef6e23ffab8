//! Quantities that a sweep varies.

/// A varied quantity.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name, with its unit.
    pub name: &'static str,
    /// Description.
    pub meaning: &'static str,
    /// Default in a grid: the paper's muscle.
    pub nominal: f64,
    /// Default range of random values.
    pub range: (f64, f64),
    /// Limits.
    pub limits: (f64, f64),
    /// Log-uniform.
    pub logarithmic: bool,
}

const fn key(
    name: &'static str,
    meaning: &'static str,
    nominal: f64,
    range: (f64, f64),
    limits: (f64, f64),
    logarithmic: bool,
) -> Key {
    Key { name, meaning, nominal, range, limits, logarithmic }
}

/// All varied quantities: the muscle, then its inputs.
pub const KEYS: [Key; 14] = [
    key("mass_g", "muscle mass", 97.5, (2.0, 1000.0), (0.01, 30e3), true),
    key("fascicle_length_cm", "L_ce0", 11.0, (2.0, 30.0), (0.5, 100.0), true),
    // L_se0/L_ce0, and the longest fascicles, L_ce0.
    key("tendon_ratio", "L_se0 / L_ce0", 0.18, (0.1, 5.0), (0.01, 50.0), true),
    key("longest_length_l0", "maximum fascicle length, L_ce0", 1.5, (1.2, 1.6), (0.9, 2.0), false),
    key(
        "slow_fraction",
        "PCSA fraction of the slow type",
        0.6,
        (0.05, 0.95),
        (0.001, 0.999),
        false,
    ),
    key("recruitment_saturation", "U_r", 0.8, (0.3, 1.0), (0.01, 1.0), false),
    // Range of activation.
    key("activation_from", "least activation", 0.2, (0.0, 1.0), (0.0, 1.0), false),
    key("activation_to", "greatest activation", 0.8, (0.0, 1.0), (0.0, 1.0), false),
    key("activation_hz", "frequency of activation", 2.0, (0.0, 10.0), (0.0, 100.0), false),
    // The path oscillates about L_se0 plus this many L_ce0, up to this speed.
    key("path_l0", "mean path length beyond L_se0, L_ce0", 1.0, (0.75, 1.1), (0.4, 2.0), false),
    key("path_l0_per_s", "peak path velocity, L_ce0/s", 1.0, (0.0, 4.0), (0.0, 20.0), false),
    key("path_hz", "frequency of the path", 2.0, (0.5, 8.0), (0.1, 100.0), false),
    key("stim_hz", "stimulation frequency, pps", 20.0, (3.0, 60.0), (0.0, 500.0), false),
    key("tick_ms", "time step", 1.0, (1.0, 1.0), (0.1, 2.0), false),
];
