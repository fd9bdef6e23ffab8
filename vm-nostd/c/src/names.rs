//! Names of fields in C, from those of the model.

/// The model's names that differ in C.
const NAMES: &[(&str, &str)] = &[
    ("mass", "mass_kg"),
    ("fascicle_length", "fascicle_length_m"),
    ("tendon_length", "tendon_length_m"),
    ("max_path_length", "max_path_length_m"),
    ("path_length", "path_length_m"),
    ("time_step", "time_step_s"),
    ("tendon.stiffness", "tendon_stiffness"),
    ("tendon.toe", "tendon_toe"),
    ("tendon.slack_length", "tendon_slack_length"),
    ("parallel.stiffness", "parallel_stiffness"),
    ("parallel.toe", "parallel_toe"),
    ("parallel.slack_length", "parallel_slack_length"),
    ("parallel.viscosity", "parallel_viscosity"),
    ("compression.strength", "compression_strength"),
    ("compression.steepness", "compression_steepness"),
    ("compression.onset_length", "compression_onset_length"),
    ("force_length.width", "force_length_width"),
    ("force_length.skewness", "force_length_skewness"),
    ("force_length.roundness", "force_length_roundness"),
    ("force_velocity.maximum_velocity", "maximum_velocity"),
    ("force_velocity.shortening", "shortening"),
    ("force_velocity.lengthening", "lengthening"),
    ("force_velocity.lengthening_velocity", "lengthening_velocity"),
    ("activation.scale", "activation_scale"),
    ("activation.exponent", "activation_exponent"),
    ("activation.length_dependence", "activation_length_dependence"),
    ("excitation.rise", "rise_s"),
    ("excitation.rise_per_frequency", "rise_per_frequency_s"),
    ("excitation.fall", "fall_s"),
    ("excitation.fall_per_activation", "fall_per_activation_s"),
    ("effective_length_time", "effective_length_time_s"),
    ("sag.resting_level", "sag_resting_level"),
    ("sag.firing_level", "sag_firing_level"),
    ("sag.time_constant", "sag_time_s"),
    ("yielding.depth", "yield_depth"),
    ("yielding.velocity", "yield_velocity"),
    ("yielding.time_constant", "yield_time_s"),
    ("threshold", "threshold_a"),
    ("saturation", "saturation_a"),
    ("chronaxie", "chronaxie_s"),
    ("fatigue_time", "fatigue_time_s"),
    ("recovery_time", "recovery_time_s"),
    ("fibers", "fiber_count"),
];

/// A field's name in C, and what follows it.
pub fn in_c(field: &'static str) -> [&'static str; 2] {
    let end = field.bytes().position(|byte| byte == b':').unwrap_or(field.len());
    let (name, rest) = field.split_at_checked(end).unwrap_or((field, ""));
    let known = NAMES.iter().find(|(model, _)| *model == name);
    [known.map_or(name, |(_, c)| c), rest]
}
