// The model in WebAssembly: numbers in, numbers out.
"use strict";

const SETS = ["paper-table-1", "human-vm4", "feline-vm4"];
const ARITHMETICS = ["f32", "fixed", "f64"];
const MODES = ["continuous", "fes", "discrete", "discrete-leff"];
const CLASSES = ["economy", "standard", "fine"];
/** Muscles that run side by side. */
const SLOTS = 10;
/** So many that V = 0 is one of them. */
const CURVE_POINTS = 121;
/** What a muscle puts out, in the order of the model. */
const OUTPUTS = ["force", "length", "velocity", "slow", "fast"];

const model = {
  wasm: null,

  async load() {
    const text = document.getElementById("wasm").textContent;
    const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
    this.wasm = (await WebAssembly.instantiate(bytes)).instance.exports;
  },

  /** Text whose bytes a function gives, one by one, until 0. */
  text(byteAt) {
    const bytes = [];
    for (let byte = byteAt(0); byte !== 0; byte = byteAt(bytes.length)) bytes.push(byte);
    return new TextDecoder().decode(new Uint8Array(bytes));
  },

  /** Puts a muscle to rest on a path (m) in a slot. Returns why it is refused; empty if it is not. */
  define(slot, muscle, path) {
    const bySize = muscle.max_isometric_force_n !== undefined;
    const defined = this.wasm.define(
      slot,
      SETS.indexOf(muscle.coefficients),
      ARITHMETICS.indexOf(muscle.arithmetic),
      MODES.indexOf(muscle.mode),
      CLASSES.indexOf(muscle.class),
      bySize ? 1 : 0,
      bySize ? muscle.max_isometric_force_n : muscle.mass_g,
      muscle.fascicle_length_cm,
      muscle.tendon_length_cm,
      muscle.max_path_length_cm,
      muscle.recruitment_saturation,
      muscle.slow,
      muscle.units,
      path,
    );
    return defined ? "" : this.text((index) => this.wasm.message_byte(index));
  },

  remove(slot) {
    this.wasm.remove(slot);
  },

  /** Steps by 1 ms and returns the bits of the status. */
  step(slot, input) {
    return this.wasm.step(slot, input.activation, input.path, input.frequency);
  },

  /** The names of a status; "ok" if no bit is set. */
  status(bits) {
    const names = [];
    for (let bit = 0; bit < 16; bit += 1) {
      if (bits & (1 << bit)) names.push(this.text((index) => this.wasm.status_name_byte(bit, index)));
    }
    return names.join("|") || "ok";
  },

  output(slot, which) {
    return this.wasm.output(slot, which);
  },

  /** What a muscle is, in SI units, L_ce0 and L_ce0/s. */
  quantities(slot) {
    const names = ["mass", "fascicle", "tendon", "maxPath", "force", "shortest", "longest"].concat(
      ["shortestFascicle", "longestFascicle", "fastest"],
    );
    return Object.fromEntries(names.map((name, index) => [name, this.wasm.quantity(slot, index)]));
  },

  /** Points of a curve between two values: 0 isometric, 1 passive, 2 force-velocity. */
  curve(slot, curve, from, to) {
    return Array.from({ length: CURVE_POINTS }, (_, index) => {
      const x = from + ((to - from) * index) / (CURVE_POINTS - 1);
      return [x, this.wasm.curve(slot, curve, x)];
    });
  },
};
