// Line charts on a canvas: axes with units, lines, a point.
"use strict";

const LINE_WIDTH = 1.75;

/** The step between ticks of an axis, so that there are about `count`. */
function tickStep(span, count) {
  const raw = span / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= raw);
}

/** A range with room for values between `least` and `most`, that ends at ticks. */
function niceRange(least, most, smallest) {
  const middle = (least + most) / 2;
  const span = Math.max(most - least, smallest);
  const [from, to] = most - least < smallest ? [middle - span / 2, middle + span / 2] : [least, most];
  const step = tickStep(span, 4);
  return [Math.floor(from / step + 1e-9) * step, Math.ceil(to / step - 1e-9) * step];
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** A number with so many decimals; what rounds to zero has no sign. */
function rounded(value, digits) {
  return value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");
}

/** The drawing surface of a canvas in CSS pixels, cleared. */
function surface(canvas) {
  const { width, height } = canvas.getBoundingClientRect();
  const scale = window.devicePixelRatio || 1;
  const [wide, high] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== wide || canvas.height !== high) {
    canvas.width = wide;
    canvas.height = high;
  }
  const context = canvas.getContext("2d");
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = "12px system-ui, sans-serif";
  return { context, width, height };
}

/** A rectangle with axes: maps values to pixels. */
class Plot {
  constructor(context, box, xRange, yRange) {
    Object.assign(this, { context, box, xRange, yRange });
  }

  x(value) {
    const [from, to] = this.xRange;
    return this.box.left + ((value - from) / (to - from)) * this.box.width;
  }

  y(value) {
    const [from, to] = this.yRange;
    return this.box.top + (1 - (value - from) / (to - from)) * this.box.height;
  }

  /** Grid and labels; the x axis is labelled if it has a title. */
  axes(xTitle, yTitle) {
    const { context, box } = this;
    context.strokeStyle = colour("--grid");
    context.fillStyle = colour("--muted");
    context.lineWidth = 1;
    const ticks = ([from, to], count) => {
      const step = tickStep(to - from, count);
      const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      const values = [];
      for (let index = Math.ceil(from / step - 1e-9); index * step <= to + 1e-9 * step; index += 1) {
        values.push([index * step, rounded(index * step, digits)]);
      }
      return values;
    };
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const [value, text] of ticks(this.yRange, Math.max(2, box.height / 35))) {
      const y = Math.round(this.y(value)) + 0.5;
      context.beginPath();
      context.moveTo(box.left, y);
      context.lineTo(box.left + box.width, y);
      context.stroke();
      context.fillText(text, box.left - 6, y);
    }
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const [value, text] of ticks(this.xRange, Math.max(2, box.width / 80))) {
      const x = Math.round(this.x(value)) + 0.5;
      context.beginPath();
      context.moveTo(x, box.top);
      context.lineTo(x, box.top + box.height);
      context.stroke();
      if (xTitle) context.fillText(text, x, box.top + box.height + 5);
    }
    context.fillStyle = colour("--text");
    if (xTitle) context.fillText(xTitle, box.left + box.width / 2, box.top + box.height + 21);
    context.textAlign = "left";
    context.textBaseline = "bottom";
    context.fillText(yTitle, box.left - 42, box.top - 5);
  }

  line(points, stroke, dash = []) {
    const { context, box } = this;
    context.save();
    context.beginPath();
    context.rect(box.left, box.top - 1, box.width, box.height + 2);
    context.clip();
    context.strokeStyle = stroke;
    context.lineWidth = LINE_WIDTH;
    context.lineJoin = "round";
    context.setLineDash(dash);
    context.beginPath();
    points.forEach(([x, y], index) => {
      if (index === 0) context.moveTo(this.x(x), this.y(y));
      else context.lineTo(this.x(x), this.y(y));
    });
    context.stroke();
    context.restore();
  }

  point(x, y, fill) {
    const { context } = this;
    const inside = (value, [from, to]) => Math.min(to, Math.max(from, value));
    context.beginPath();
    context.arc(this.x(inside(x, this.xRange)), this.y(inside(y, this.yRange)), 5, 0, 2 * Math.PI);
    context.fillStyle = fill;
    context.fill();
    context.strokeStyle = colour("--panel");
    context.lineWidth = 2;
    context.stroke();
  }
}

/** Least and most of the values of several lists. */
function extent(lists) {
  let [least, most] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (value < least) least = value;
      if (value > most) most = value;
    }
  }
  return least <= most ? [least, most] : [0, 1];
}

/**
 * Plots above each other on one time axis. Each panel: `title`, `lines` of `points`, `colour` and
 * perhaps `dash`, `smallest` (the least span of its axis), `from` (where the axis starts at most).
 */
function drawScope(canvas, panels, timeRange) {
  const { context, width, height } = surface(canvas);
  const [left, right, top, bottom, gap] = [48, 12, 22, 38, 26];
  const each = (height - top - bottom - gap * (panels.length - 1)) / panels.length;
  panels.forEach((panel, index) => {
    const box = { left, top: top + index * (each + gap), width: width - left - right, height: each };
    let [least, most] = extent(panel.lines.map((line) => line.points.map((point) => point[1])));
    if (panel.from !== undefined) least = Math.min(least, panel.from);
    const plot = new Plot(context, box, timeRange, niceRange(least, most, panel.smallest));
    plot.axes(index === panels.length - 1 ? "time, s" : "", panel.title);
    for (const line of panel.lines) plot.line(line.points, line.colour, line.dash);
  });
}

/** Curves with an operating point. */
function drawCurves(canvas, xTitle, yTitle, curves, point) {
  const { context, width, height } = surface(canvas);
  const box = { left: 48, top: 22, width: width - 60, height: height - 60 };
  const all = curves.flatMap((curve) => curve.points);
  const [least, most] = extent([all.map(([x]) => x)]);
  const [low, high] = extent([all.map(([, y]) => Math.min(y, 2))]);
  const plot = new Plot(context, box, niceRange(least, most, 0.1), niceRange(Math.min(0, low), high, 0.5));
  plot.axes(xTitle, yTitle);
  for (const curve of curves) plot.line(curve.points, colour(curve.colour), curve.dash);
  plot.point(point[0], point[1], colour("--point"));
}
