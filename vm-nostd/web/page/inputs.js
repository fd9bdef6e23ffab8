// What the muscles are given in each tick.
"use strict";

/** A tick, s. */
const TICK = 1e-3;
/** The path follows its slider at most at this speed, L_ce0/s: a jump would tear at the tendon. */
const PATH_SPEED = 1;
/** Duration of a ramp up or down, of a train and of its pause, and of a stride, s. */
const RAMP = 2;
const TRAIN = 1;
const STRIDE = 1.1;
/** How far the path of a stride goes to each side, L_ce0. */
const EXCURSION = 0.1;

/** Shares of the sliders' values at a time (s), and the path beside its slider's (L_ce0). */
const PATTERNS = {
  hold: () => ({ activation: 1, frequency: 1, path: 0 }),
  // Activation up and down; stimulation as it is.
  ramp: (time) => {
    const phase = (time / RAMP) % 2;
    return { activation: phase < 1 ? phase : 2 - phase, frequency: 1, path: 0 };
  },
  // On and off.
  train: (time) => {
    const on = (time / TRAIN) % 2 < 1 ? 1 : 0;
    return { activation: on, frequency: on, path: 0 };
  },
  // A path that swings, and a burst while it is lengthened and begins to shorten.
  gait: (time) => {
    const phase = (2 * Math.PI * time) / STRIDE;
    const burst = Math.max(0, Math.sin(phase - Math.PI / 6));
    return { activation: burst * burst, frequency: 1, path: EXCURSION * Math.sin(phase) };
  },
};

/** The first second of the same in Rust, of the sliders' values and L_ce0 (m): U, pps and path (m). */
const PATTERNS_IN_RUST = {
  hold: (activation, frequency, path) => [activation, frequency, path],
  ramp: (activation, frequency, path) => [`${activation} * (time / ${RAMP}.0)`, frequency, path],
  train: (activation, frequency, path) => {
    const on = (value) => `if time < ${TRAIN}.0 { ${value} } else { 0.0 }`;
    return [on(activation), on(frequency), path];
  },
  gait: (activation, frequency, path, fascicle) => {
    const phase = `std::f64::consts::TAU * time / ${STRIDE}`;
    const burst = `(${phase} - std::f64::consts::FRAC_PI_6).sin().max(0.0)`;
    const swing = `${path} + ${EXCURSION} * (${phase}).sin() * ${fascicle}`;
    return [`${activation} * ${burst}.powi(2)`, frequency, swing];
  },
};

/** The path of the slider that the muscles are on, m. */
function followed(current, wanted, fascicle) {
  const most = PATH_SPEED * fascicle * TICK;
  return current + Math.min(most, Math.max(-most, wanted - current));
}

/** The input of the tick that ends at a time (s), on a path (m) beside the pattern's. */
function inputAt(pattern, time, sliders, path, fascicle) {
  const share = PATTERNS[pattern](time);
  return {
    activation: sliders.activation * share.activation,
    frequency: sliders.frequency * share.frequency,
    path: path + share.path * fascicle,
  };
}
