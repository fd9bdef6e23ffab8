// The page: muscles that run side by side on the same inputs, slot 0 being that of the controls.
"use strict";

/** Ticks that are kept: of these a run can be saved. */
const KEPT_TICKS = 60_000;
/** Most ticks that are made up for in a frame: a page in the background does not catch up. */
const MOST_TICKS = 100;
/** A screen reader is told the force of a run as often as this, and all numbers so soon after, ms. */
const SPOKEN_EVERY = 3000;
const SPOKEN_AFTER = 500;

const data = JSON.parse(element("data").textContent);

/** What ran in a slot: its outputs by tick, in rings. */
function track(muscle, force) {
  const rings = OUTPUTS.map(() => new Float64Array(KEPT_TICKS));
  return { muscle, force, rings, status: new Uint16Array(KEPT_TICKS), from: 0 };
}

const run = {
  /** Ticks since the rest; index 0 of the rings is the rest itself. */
  tick: 0,
  /** Nothing moves by itself for who wants less motion. */
  running: !matchMedia("(prefers-reduced-motion: reduce)").matches,
  /** Whether what is drawn is no more what it was. */
  stale: true,
  /** The slider's path that the muscles are on, m. */
  path: 0,
  inputs: ["activation", "path", "frequency"].map(() => new Float64Array(KEPT_TICKS)),
  tracks: new Array(SLOTS).fill(null),
  quantities: null,
  curves: null,
};

function keepOutputs(slot, status) {
  const place = run.tick % KEPT_TICKS;
  const kept = run.tracks[slot];
  kept.rings.forEach((ring, which) => {
    ring[place] = model.output(slot, which);
  });
  kept.status[place] = status;
}

/** Puts all muscles to rest on a path (m); a refusal is shown, and the run stands as it was. */
function restart(path = sliders().path) {
  const muscle = chosenMuscle(data);
  let refusal = model.define(0, muscle, path);
  if (refusal === "") {
    run.quantities = model.quantities(0);
    run.tracks[0] = track(muscle, run.quantities.force);
    const { shortestFascicle, longestFascicle, fastest } = run.quantities;
    run.curves = [
      model.curve(0, 0, shortestFascicle, longestFascicle),
      model.curve(0, 1, shortestFascicle, longestFascicle),
      model.curve(0, 2, fastest, -fastest),
    ];
    run.tick = 0;
    run.path = path;
    run.inputs[1][0] = path;
    run.inputs[0][0] = 0;
    run.inputs[2][0] = 0;
    keepOutputs(0, 0);
    for (let slot = 1; slot < SLOTS; slot += 1) {
      if (!run.tracks[slot]) continue;
      const kept = run.tracks[slot];
      // Its own path where it differs: kept muscles follow the first by the same change of path.
      const problem = model.define(slot, kept.muscle, kept.rest);
      refusal ||= problem;
      Object.assign(kept, { from: 0, base: path });
      keepOutputs(slot, 0);
    }
  }
  element("refusal").textContent = refusal;
  showCycles(data, muscle);
  showSliders();
  run.stale = true;
}

/** Steps all muscles by one tick. */
function tick() {
  run.tick += 1;
  const chosen = sliders();
  const { fascicle } = run.quantities;
  run.path = followed(run.path, chosen.path, fascicle);
  const input = inputAt(element("pattern").value, run.tick * TICK, chosen, run.path, fascicle);
  const place = run.tick % KEPT_TICKS;
  [input.activation, input.path, input.frequency].forEach((value, which) => {
    run.inputs[which][place] = value;
  });
  run.tracks.forEach((kept, slot) => {
    if (!kept) return;
    const path = slot === 0 ? input.path : kept.rest + (input.path - kept.base);
    keepOutputs(slot, model.step(slot, { ...input, path }));
  });
}

function advance(ticks) {
  for (let count = 0; count < ticks; count += 1) tick();
  run.stale ||= ticks > 0;
}

/** Points of a ring in the last seconds, thinned to about one a pixel. */
function points(ring, from, stride) {
  const found = [];
  const first = Math.max(from, run.tick - SPAN / TICK);
  for (let index = Math.ceil(first / stride) * stride; index <= run.tick; index += stride) {
    found.push([index * TICK, ring[index % KEPT_TICKS]]);
  }
  if (run.tick % stride !== 0) found.push([run.tick * TICK, ring[run.tick % KEPT_TICKS]]);
  return found;
}

function draw() {
  const width = element("scope").clientWidth || 600;
  const stride = Math.max(1, Math.floor(SPAN / TICK / width));
  const now = run.tick * TICK;
  const time = now < SPAN ? [0, SPAN] : [now - SPAN, now];
  const lines = (which) =>
    run.tracks.flatMap((kept, slot) =>
      kept
        ? [{ points: points(kept.rings[which], kept.from, stride), colour: colour(`--line-${slot}`) }]
        : [],
    );
  const dashed = (line) => ({ ...line, dash: [5, 4] });
  drawScope(
    element("scope"),
    [
      { title: "tendon force, N", lines: lines(0), smallest: 1, from: 0 },
      { title: "fascicle length, L0", lines: lines(1), smallest: 0.05 },
      { title: "fascicle velocity, L0/s", lines: lines(2), smallest: 0.2 },
      {
        title: "activation, F0: slow —, fast - -",
        lines: [...lines(3), ...lines(4).map(dashed)],
        smallest: 0.1,
        from: 0,
      },
    ],
    time,
  );
  const place = run.tick % KEPT_TICKS;
  const kept = run.tracks[0];
  const [force, length, velocity, slow, fast] = kept.rings.map((ring) => ring[place]);
  const relative = force / kept.force;
  const [isometric, passive, byVelocity] = run.curves;
  drawCurves(element("force-length"), "fascicle length, L0", "force, F0", [
    { points: isometric, colour: "--line-0" },
    { points: passive, colour: "--line-1", dash: [5, 4] },
  ], [length, relative]);
  drawCurves(element("force-velocity"), "fascicle velocity, L0/s", "force, F0", [
    { points: byVelocity, colour: "--line-0" },
  ], [velocity, relative]);
  const [activation, path] = run.inputs.map((ring) => ring[place]);
  const status = model.status(kept.status[place]);
  const numbers = { time: now, activation, path, force, relative, length, velocity, slow, fast, status };
  return showNumbers(numbers, run.running);
}

function showRunning() {
  element("run").textContent = run.running ? "Pause" : "Run";
  run.stale = true;
}

function legend() {
  run.stale = true;
  showLegend(
    run.tracks.flatMap((kept, slot) => {
      if (!kept) return [];
      const { name, mode, arithmetic } = kept.muscle;
      return [{ name: `${name.replaceAll("_", " ")}, ${mode}, ${arithmetic}`, stroke: `--line-${slot}` }];
    }),
  );
}

/** The muscle of the controls runs on beside the next one. */
function keep() {
  const slot = run.tracks.findIndex((kept, index) => index > 0 && !kept);
  if (slot < 0) {
    element("refusal").textContent = `at most ${SLOTS} muscles run side by side`;
    return;
  }
  const kept = track(run.tracks[0].muscle, run.quantities.force);
  run.tracks[slot] = kept;
  const item = document.createElement("li");
  const { name, mode, arithmetic } = kept.muscle;
  const remove = document.createElement("button");
  remove.type = "button";
  remove.textContent = "Remove";
  remove.setAttribute("aria-label", `Remove ${name}, ${mode}, ${arithmetic}`);
  remove.addEventListener("click", () => {
    run.tracks[slot] = null;
    model.remove(slot);
    item.remove();
    legend();
    element("keep").focus();
  });
  item.append(`${name.replaceAll("_", " ")}, ${mode}, ${arithmetic}`, remove);
  element("kept").append(item);
  kept.rest = sliders().path;
  restart();
  legend();
}

/** Shows a text, and copies it where the browser lets it. */
async function copy(text, what) {
  const area = element("text");
  area.hidden = false;
  area.value = text;
  area.select();
  try {
    await navigator.clipboard.writeText(text);
    element("copied").textContent = `${what}: copied.`;
  } catch {
    element("copied").textContent = `${what}: copy it from below.`;
  }
}

function recorded() {
  if (run.tick >= KEPT_TICKS) return null;
  const kept = run.tracks[0];
  return Array.from({ length: run.tick + 1 }, (_, index) => {
    const [activation, path, frequency] = run.inputs.map((ring) => ring[index]);
    const [force, length, velocity] = kept.rings.map((ring) => ring[index]);
    const time = index / 1000;
    const status = model.status(kept.status[index]);
    return { time, activation, path, frequency, force, length, velocity, status };
  });
}

function copyRun() {
  const rows = recorded();
  if (rows) copy(runFile(rows), "Run");
  else {
    element("text").hidden = true;
    element("copied").textContent = `Only ${KEPT_TICKS * TICK} s can be saved: restart at rest.`;
  }
}

/** A muscle of the list: on the path on which fascicles and tendon have their optimal lengths. */
function choose() {
  const muscle = data.muscles[Number(element("muscle").value)];
  showMuscle(muscle);
  const path = muscle.max_path_length_cm / 100;
  // Defined once, to know its paths.
  model.define(0, chosenMuscle(data), path);
  const quantities = model.quantities(0);
  const { fascicle, tendon, maxPath } = quantities;
  showPathRange(quantities, (100 * Math.min(fascicle + tendon, maxPath)).toFixed(2));
  restart();
  legend();
}

/** Fibre types decide the shortest path. */
function redefine() {
  restart();
  showPathRange(run.quantities);
  legend();
}

function listen() {
  const on = (id, event, handle) => element(id).addEventListener(event, handle);
  on("muscle", "change", choose);
  for (const id of ["coefficients", "mode", "units", "arithmetic", "class"]) on(id, "change", redefine);
  on("slow", "input", redefine);
  for (const id of ["activation", "frequency", "path"]) on(id, "input", showSliders);
  on("pattern", "change", () => restart());
  on("core", "change", () => showCycles(data, run.tracks[0].muscle));
  on("run", "click", () => {
    run.running = !run.running;
    showRunning();
  });
  on("advance", "click", () => advance(100));
  on("restart", "click", () => restart());
  on("keep", "click", keep);
  on("copy-toml", "click", () => copy(muscleFile(run.tracks[0].muscle), "Muscle TOML"));
  on("copy-rust", "click", () => {
    const { muscle } = run.tracks[0];
    copy(program(muscle, run.quantities, sliders(), element("pattern").value), "Rust");
  });
  on("copy-run", "click", copyRun);
  const redraw = () => {
    run.stale = true;
  };
  addEventListener("resize", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  element("controls").addEventListener("submit", (event) => event.preventDefault());
}

/** Runs in real time. */
function loop() {
  let last = performance.now();
  let owed = 0;
  let spoken = last;
  let sentence = "";
  const frame = (time) => {
    owed = Math.min(owed + (time - last), MOST_TICKS);
    last = time;
    const ticks = Math.floor(owed);
    owed -= ticks;
    if (run.running) advance(ticks);
    if (run.stale) sentence = draw();
    run.stale = false;
    if (time - spoken > (run.running ? SPOKEN_EVERY : SPOKEN_AFTER)) {
      spoken = time;
      if (element("spoken").textContent !== sentence) element("spoken").textContent = sentence;
    }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

async function start() {
  await model.load();
  fillLists(data);
  listen();
  choose();
  showRunning();
  loop();
}

start().catch((error) => {
  element("refusal").textContent = `The page could not start: ${error.message}`;
  throw error;
});
