// What is read from the controls and shown beside the charts.
"use strict";

const element = (id) => document.getElementById(id);

/** Seconds of the scope. */
const SPAN = 5;
/** Motor units of each type for which cycles were counted, and 30 as the paper has. */
const UNITS = [1, 3, 6, 15, 30];
const CORE_NAMES = {
  "cortex-m4f": "Cortex-M4F",
  "cortex-m3": "Cortex-M3",
  "cortex-m0plus": "Cortex-M0+",
};

/** Fills a list with options, of which the first is chosen. */
function fill(id, options, chosen) {
  element(id).replaceChildren(
    ...options.map(([value, text]) => new Option(text, value, false, String(value) === String(chosen))),
  );
}

function fillLists(data) {
  fill("muscle", data.muscles.map((muscle, index) => [index, muscle.name.replaceAll("_", " ")]), 0);
  fill("coefficients", SETS.map((set) => [set, set]), SETS[0]);
  fill("mode", [
    ["continuous", "natural, continuous"],
    ["fes", "intramuscular FES"],
    ["discrete", "natural, motor units"],
    ["discrete-leff", "the same, effective length"],
  ], "fes");
  fill("units", UNITS.map((units) => [units, units]), 30);
  fill("arithmetic", [["f32", "f32"], ["fixed", "fixed point"], ["f64", "f64"]], "f32");
  fill("class", CLASSES.map((name) => [name, name]), "standard");
  fill("pattern", Object.keys(PATTERNS).map((name) => [name, name]), "hold");
  const cores = [...new Set(data.cycles.map((row) => row.core))];
  fill("core", cores.map((core) => [core, CORE_NAMES[core] ?? core]), cores[0]);
}

/** The muscle of the controls. */
function chosenMuscle(data) {
  return {
    ...data.muscles[Number(element("muscle").value)],
    coefficients: element("coefficients").value,
    mode: element("mode").value,
    units: Number(element("units").value),
    arithmetic: element("arithmetic").value,
    class: element("class").value,
    slow: Number(element("slow").value) / 100,
  };
}

/** Sets the controls that a muscle of the list decides. */
function showMuscle(muscle) {
  element("coefficients").value = muscle.coefficients;
  element("slow").value = Math.round(100 * muscle.slow);
  element("source").textContent = muscle.source;
}

/** Sets the range of the path's slider (cm), and its value where it is outside. */
function showPathRange(quantities, wanted) {
  const slider = element("path");
  const [shortest, longest] = [quantities.shortest, quantities.maxPath].map((path) => path * 100);
  slider.min = (Math.ceil(shortest * 100) / 100).toFixed(2);
  slider.max = (Math.floor(longest * 100) / 100).toFixed(2);
  slider.step = 0.01;
  if (wanted !== undefined) slider.value = wanted;
}

/** Values of the sliders: activation, frequency (pps), path (m). */
function sliders() {
  const value = (id) => Number(element(id).value);
  return { activation: value("activation"), frequency: value("frequency"), path: value("path") / 100 };
}

function showSliders() {
  const texts = {
    slow: `${element("slow").value} %`,
    activation: Number(element("activation").value).toFixed(2),
    frequency: `${element("frequency").value} pps`,
    path: `${Number(element("path").value).toFixed(2)} cm`,
  };
  for (const [id, text] of Object.entries(texts)) {
    element(`${id}-value`).textContent = text;
    element(id).setAttribute("aria-valuetext", text);
  }
  const mode = element("mode").value;
  element("units-label").hidden = !mode.startsWith("discrete");
  element("frequency").disabled = mode !== "fes";
}

/** Cycles per tick of the chosen core, or that none were counted. */
function showCycles(data, muscle) {
  const core = element("core").value;
  const name = CORE_NAMES[core] ?? core;
  const row = data.cycles.find(
    (row) =>
      row.core === core &&
      row.mode === muscle.mode &&
      row.arithmetic === muscle.arithmetic &&
      row.class === muscle.class &&
      (row.units === undefined || row.units === muscle.units),
  );
  const what = `${muscle.mode}, ${muscle.arithmetic}, ${muscle.class}`;
  if (!row) {
    element("cycles").textContent = `Not counted on a ${name}: ${what}.`;
    return;
  }
  const most = row.most === null ? "" : `, at most ${row.most}`;
  element("cycles").textContent = `${row.typical} cycles per tick${most} (${name}, ${what})`;
}

/**
 * The table of numbers; returns a sentence for screen readers: with all of it while the run stands,
 * else with what is read before the next comes.
 */
function showNumbers(now, running) {
  const rows = [
    ["Time", `${now.time.toFixed(3)} s`],
    ["Activation U", now.activation.toFixed(3)],
    ["Path length", `${(100 * now.path).toFixed(3)} cm`],
    ["Force", `${rounded(now.force, 3)} N`],
    ["Force", `${rounded(now.relative, 4)} F0`],
    ["Fascicle length", `${now.length.toFixed(4)} L0`],
    ["Fascicle velocity", `${rounded(now.velocity, 4)} L0/s`],
    ["Slow fibres", `${rounded(now.slow, 4)} F0`],
    ["Fast fibres", `${rounded(now.fast, 4)} F0`],
    ["Status", now.status.replaceAll("|", ", ")],
  ];
  const body = element("numbers");
  if (body.rows.length !== rows.length) {
    body.replaceChildren(
      ...rows.map(([name]) => {
        const row = document.createElement("tr");
        const head = document.createElement("th");
        head.scope = "row";
        head.textContent = name;
        row.append(head, document.createElement("td"));
        return row;
      }),
    );
  }
  rows.forEach(([, text], index) => {
    body.rows[index].cells[1].textContent = text;
  });
  const status = now.status === "ok" ? "" : `, ${now.status.replaceAll("|", ", ")}`;
  if (running) return `Force ${rounded(now.force, 1)} N${status}`;
  return rows.map(([name, text]) => `${name} ${text}`).join(", ");
}

/** The legend of the scope: a line and a name for each. */
function showLegend(entries) {
  element("legend").replaceChildren(
    ...entries.flatMap(({ name, stroke, dash }) => {
      const line = document.createElement("i");
      line.style.color = `var(${stroke})`;
      if (dash) line.style.borderTopStyle = "dashed";
      return [line, document.createTextNode(name)];
    }),
  );
}
