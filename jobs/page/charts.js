// Curves of one event: measured, submitted model and current model, with synchronised cursors.
/* global curves, uPlot */
import { by, make } from "./format.js";

const { colour } = curves;
const sync = uPlot.sync("event");
const charts = [];
let moving = 0; // number of the current animation; a new number ends it

/** Splits the samples of api.curves() into t and, for each channel, measured and modelled samples and 95 % band. */
export function split(samples, channels) {
  const n = samples.length / (1 + 3 * channels);
  const part = (k) => samples.subarray(k * n, (k + 1) * n);
  const channel = (c) => {
    const [measured, modelled, half] = [part(1 + 3 * c), part(2 + 3 * c), part(3 + 3 * c)];
    if (Number.isNaN(half[0])) return { measured, modelled, band: null };
    const band = [modelled.map((v, k) => v - half[k]), modelled.map((v, k) => v + half[k])];
    return { measured, modelled, band, widest: half.reduce((a, b) => Math.max(a, b)) };
  };
  return { t: part(0), channels: Array.from({ length: channels }, (_, c) => channel(c)) };
}

/** Fills the area between two curves. */
function between(u, t, low, high, fill, alpha) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.beginPath();
  const x = (k) => u.valToPos(t[k], "x", true),
    y = (v) => u.valToPos(v, "y", true);
  for (let k = 0; k < t.length; ++k) ctx.lineTo(x(k), y(low[k]));
  for (let k = t.length - 1; k >= 0; --k) ctx.lineTo(x(k), y(high[k]));
  ctx.globalAlpha = alpha;
  ctx.fillStyle = colour(fill);
  ctx.fill();
  ctx.restore();
}

const series = [
  { name: "measured", ink: "measured" },
  { name: "submitted", ink: "ghost" },
  { name: "this model", ink: "model" },
];
function chart(place, of, height) {
  of.series = series;
  const options = curves.options(of, {
    title: `${of.name} [${of.unit}]`,
    width: place.clientWidth || 600,
    height,
    group: sync.key,
    below: (u) => {
      if (of.allowed) between(u, of.data[0], ...of.allowed, "good", 0.1);
      if (of.band) between(u, of.data[0], ...of.band, "model", 0.3);
      if (of.range) between(u, of.data[0], ...of.range, "model", 0.3);
    },
  });
  const box = make("div", { className: "chart" });
  place.append(box);
  const plot = new uPlot(options, of.data, box);
  sync.sub(plot);
  return { plot, of, place, height };
}

/** Shows channels {name, unit, data: [t, measured, submitted, current model], band, window, fault, allowed, main}. */
export function show(channels) {
  ++moving;
  for (const c of charts.splice(0)) {
    sync.unsub(c.plot);
    c.plot.destroy();
  }
  by("charts").replaceChildren();
  by("others").replaceChildren();
  const tall = Math.max(170, Math.min(290, innerHeight * 0.29));
  for (const of of channels) charts.push(chart(of.main ? by("charts") : by("others"), of, of.main ? tall : 180));
  by("more").hidden = channels.every((c) => c.main);
}
/** Replaces the modelled samples of every channel. */
export function model(samples) {
  ++moving;
  samples.forEach((s, k) => put(k, s));
}
function put(channel, samples) {
  const c = charts[channel];
  if (!c) return;
    c.of.band = null; // it belongs to the previous curve
  c.of.data = [c.of.data[0], c.of.data[1], c.of.data[2], samples];
  if (c.plot.root.offsetParent !== null) (c.plot.setData(c.of.data, false), c.plot.redraw(true, false));
}
/** Animates the modelled curves from their present shape to the new samples. */
export function animate(next, done = () => {}) {
  const start = charts.map((c) => c.of.data[3]);
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const own = ++moving;
  const begin = performance.now(),
    span = still ? 0 : 700;
  const frame = (now) => {
    if (own !== moving) return;
    const share = span ? Math.min(1, (now - begin) / span) : 1,
      eased = share * (2 - share);
    next.forEach((to, k) => {
      const from = start[k];
      if (!from || from.length !== to.length || share === 1) return put(k, to);
      put(
        k,
        to.map((v, i) => from[i] + (v - from[i]) * eased),
      );
    });
    if (share < 1) requestAnimationFrame(frame);
    else done();
  };
  requestAnimationFrame(frame);
}
/** Returns the data of each chart: t, measured, submitted model, current model. For tests. */
globalThis.charts_of_test = () => charts.map((c) => c.of.data);
globalThis.bands_of_test = () => charts.map((c) => c.of.band);
/** Shows the times `from` to `to` [s] in every chart; without arguments, the whole record. */
export function zoom(from, to) {
  for (const c of charts) {
    const t = c.of.data[0];
    c.plot.setScale("x", { min: from ?? t[0], max: to ?? t[t.length - 1] });
  }
}
/** Shows the 95 % band of each modelled curve. */
export function bands(all) {
  charts.forEach((c, k) => {
    c.of.band = all[k];
    c.plot.redraw(false);
  });
}
/** Shades the window [from, to] of each chart, if it has one. */
export function shade(windows) {
  charts.forEach((c, k) => {
    c.of.window = windows[k];
    c.plot.redraw(false);
  });
}
export function choose(channel) {
  charts.forEach((c, k) => c.plot.root.parentElement.classList.toggle("chosen", k === channel));
  if (channel > 1) by("more").open = true;
}
/** Shows the area between two responses of each channel; null: none. */
export function ribbon(ranges) {
  charts.forEach((c, k) => {
    c.of.range = ranges?.[k];
    c.plot.redraw(false);
  });
}
function fitted() {
  for (const c of charts) if (c.place.clientWidth) c.plot.setSize({ width: c.place.clientWidth, height: c.height });
}
new ResizeObserver(fitted).observe(by("charts"));
by("more").addEventListener("toggle", () => {
  fitted();
  for (const c of charts) (c.plot.setData(c.of.data, false), c.plot.redraw(true));
});

/** Draws a small curve of an inferred input. */
export function small(place, title, t, values) {
  const axis = { stroke: colour("soft"), grid: { stroke: colour("line"), width: 1 }, ticks: { show: false } };
  const box = make("div", { className: "chart" });
  place.append(box);
  new uPlot(
    {
      title,
      width: place.clientWidth || 360,
      height: 120,
      legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false } },
      axes: [
        { ...axis, size: 26 },
        { ...axis, size: 44 },
      ],
      series: [{}, { stroke: colour("model"), width: 2, points: { show: false } }],
    },
    [t, values],
    box,
  );
}
