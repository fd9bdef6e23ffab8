// What is taken from the page: a muscle file, ten lines of Rust, a run.
"use strict";

/** A number as Rust and TOML read a float. */
function float(value) {
  const text = String(value);
  return /[.e]/.test(text) ? text : `${text}.0`;
}

/** The fraction of fast fibres, in hundredths as its slider's. */
function fastFraction(muscle) {
  return Math.round(100 * (1 - muscle.slow)) / 100;
}

/** The muscle as a file for `vm run --muscle`. */
function muscleFile(muscle) {
  const size = muscle.max_isometric_force_n !== undefined ? "max_isometric_force_n" : "mass_g";
  const keys = [size, "fascicle_length_cm", "tendon_length_cm", "max_path_length_cm"];
  const lines = keys.map((key) => `${key} = ${float(muscle[key])}`);
  const units = muscle.mode.startsWith("discrete") ? `units = ${muscle.units}\n` : "";
  const fiber = (type, fraction) =>
    `\n[[fiber]]\npreset = "${muscle.coefficients}/${type}"\nfraction = ${float(fraction)}\n${units}`;
  return `# vm run --muscle FILE --mode ${muscle.mode} --arithmetic ${muscle.arithmetic} \
--class ${muscle.class} --input run.csv
name = "${muscle.name}"
${lines.join("\n")}
recruitment_saturation = ${float(muscle.recruitment_saturation)}
coefficients = "${muscle.coefficients}"
${fiber("slow", muscle.slow)}${fiber("fast", fastFraction(muscle))}`;
}

/** The muscle and the first second of its input from rest as a program. */
function program(muscle, quantities, input, pattern) {
  const preset = muscle.coefficients.replaceAll("-", "_");
  const type = {
    continuous: "ContinuousMuscle::<S, 2>",
    fes: "FesMuscle::<S, 2>",
    discrete: "DiscreteMuscle::<S, 2, 64>",
    "discrete-leff": "EffectiveLengthMuscle::<S, 2, 64>",
  }[muscle.mode];
  const scalar = { f32: "f32", fixed: "Fixed", f64: "f64" }[muscle.arithmetic];
  const accuracy = { economy: "Economy", standard: "Standard", fine: "Fine" }[muscle.class];
  const build = muscle.mode.startsWith("discrete")
    ? `build_with_units(&params, &MotorUnits::new(&params, [UnitSizes::Default(${muscle.units}); 2])?, `
    : "build(&params, ";
  const numbers = [input.activation, input.frequency, input.path, quantities.fascicle].map(float);
  const [activation, frequency, path] = PATTERNS_IN_RUST[pattern](...numbers);
  const time = pattern === "hold" ? "_" : "time";
  return `use vm_nostd::{${preset}::{ELEMENTS, FAST, SLOW}, *};
type S = ${scalar};
fn main() -> Result<(), ParameterError> {
    let fibers = [(${float(muscle.slow)}, SLOW), (${float(fastFraction(muscle))}, FAST)].map(|(fraction, fiber_type)| FiberParams { fraction, fiber_type });
    let params = MuscleParams { mass: ${float(quantities.mass)}, fascicle_length: ${float(quantities.fascicle)}, tendon_length: ${float(quantities.tendon)}, max_path_length: ${float(quantities.maxPath)}, recruitment_saturation: ${float(muscle.recruitment_saturation)}, class: Class::${accuracy}, elements: ELEMENTS, fibers };
    let muscle = ${type}::${build}TimeStep::MILLISECOND)?;
    let mut state = muscle.rest(S::path_length(${float(input.path)}))?;
    let input = |${time}: f64| Input { activation: S::from_f64(${activation}), path_length: S::path_length(${path}), stimulation_frequency: S::quantity(${frequency}) };
    (1..=1000).for_each(|tick| println!("{} N", S::newtons(muscle.step(&mut state, input(f64::from(tick) * 1e-3)).force)));
    Ok(()) }
`;
}

/** A run: its inputs in the columns of `vm run --input`, then its outputs, all digits. */
function runFile(rows) {
  const line = (row) =>
    [row.time, row.activation, row.path, row.frequency]
      .concat([row.force, row.length, row.velocity, row.status])
      .join(",");
  const header =
    "t_s,activation,path_length_m,stim_hz,force_n,fascicle_length_l0,fascicle_velocity_l0_per_s,status";
  return `${[header, ...rows.map(line)].join("\n")}\n`;
}
