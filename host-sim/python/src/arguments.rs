//! What arguments are called here, and their units.

/// Field of the library, argument of this package, and its units per SI unit.
pub const ARGUMENTS: &[(&str, &str, f64)] = &[
    ("path_length", "path_length_m", 1.0),
    ("time_step", "time_step_s", 1.0),
    ("fatigue_time", "fatigue_time_s", 1.0),
    ("recovery_time", "recovery_time_s", 1.0),
    ("angle_range.least", "angle_ranges_rad", 1.0),
    ("angle_range.most", "angle_ranges_rad", 1.0),
    ("path.length", "path.length_m", 1.0),
    ("path.reference", "path.reference_rad", 1.0),
    ("path.terms", "path.terms_m_per_rad", 1.0),
    ("path.product", "path.product_m_per_rad2", 1.0),
    ("limb.inertia", "inertia_kg_m2", 1.0),
    ("limb.damping", "damping_nm_s_per_rad", 1.0),
    ("limb.gravity", "gravity_nm", 1.0),
    ("limb.hanging_angle", "hanging_angle_rad", 1.0),
    ("pi.proportional", "proportional_nm_per_rad", 1.0),
    ("pi.integral", "integral_nm_per_rad_s", 1.0),
    ("pi.derivative", "derivative_nm_s_per_rad", 1.0),
    ("pi.derivative_filter", "derivative_filter_s", 1.0),
    ("pi.most", "most_integral_nm", 1.0),
    ("stimulation_frequency", "stimulation_frequency_pps", 1.0),
    ("cocontraction", "cocontraction_nm", 1.0),
    ("expected_lag", "expected_lag_s", 1.0),
    ("lead.filter_time", "lead_filter_s", 1.0),
    ("modulation.amplitude", "pulse_amplitude_ma", 1e3),
    ("modulation.width", "pulse_width_us", 1e6),
    ("torque.0", "torque_range_nm[0]", 1.0),
    ("torque.1", "torque_range_nm[1]", 1.0),
    ("gain.time", "gain.time_s", 1.0),
    ("gain.excitation", "gain.excitation_nm", 1.0),
    ("envelope.rest", "envelope.rest_mv", 1.0),
    ("envelope.maximal", "envelope.maximal_mv", 1.0),
    ("envelope.cutoff_frequency", "envelope.cutoff_frequency_hz", 1.0),
    ("envelope.delay", "envelope.delay_s", 1.0),
    ("torque.least", "torque_limits[0]", 1.0),
    ("torque.most", "torque_limits[1]", 1.0),
    ("torque.rate", "torque_limits[2]", 1.0),
    ("stiffness.least", "stiffness_limits[0]", 1.0),
    ("stiffness.most", "stiffness_limits[1]", 1.0),
    ("stiffness.rate", "stiffness_limits[2]", 1.0),
];

/// A number in the argument's unit, without the rounding noise of the conversion.
pub fn in_unit(value: f64, scale: f64) -> f64 {
    if scale == 1.0 {
        return value;
    }
    format!("{:.9e}", value * scale).parse().unwrap_or(value * scale)
}
