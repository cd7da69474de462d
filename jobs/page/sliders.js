// Sliders of the parameters, grouped by block; logarithmic if the parameter is positive.
import { by, digits, make } from "./format.js";

const kSteps = 1000;
const rows = new Map();

const place = (p, v) => {
  if (p.high === p.low) return 0;
  const share = p.log ? Math.log(v / p.low) / Math.log(p.high / p.low) : (v - p.low) / (p.high - p.low);
  return Math.max(0, Math.min(1, share));
};
const value = (p, share) => (p.log ? p.low * (p.high / p.low) ** share : p.low + (p.high - p.low) * share);
// The range of the thumb's centre is the track's width minus one thumb.
const left = (share) => `calc(${share} * (100% - var(--thumb)) + var(--thumb) / 2)`;

function row(p, moved, settled, point) {
  const id = "slider-" + p.name;
  const range = make("input", {
    type: "range",
    id,
    min: 0,
    max: kSteps,
    step: 1,
    value: Math.round(kSteps * place(p, p.value)),
  });
  range.setAttribute("aria-valuetext", digits(p.value) + " " + p.unit);
  const box = make("input", { type: "number", step: "any", value: Number(digits(p.value, 5)) });
  box.setAttribute("aria-label", p.name + " as a number");
  const track = make("div", { className: "track" });
  if (p.interval && p.interval[0] !== null) {
    const a = place(p, Math.max(p.interval[0], p.low)),
      b = place(p, Math.min(p.interval[1], p.high));
    const band = make("div", {
      className: "interval",
      title: `95 % interval: ${digits(p.interval[0])} to ${digits(p.interval[1])} ${p.unit}`,
    });
    band.style.left = left(a);
    band.style.width = `calc(${b - a} * (100% - var(--thumb)) + 2px)`;
    track.append(band);
  }
  if (p.submitted !== undefined) {
    const mark = make("div", { className: "mark", textContent: "▲" });
    mark.style.left = left(place(p, p.submitted));
    track.append(mark);
  }
  track.append(range);
  const label = make("label", { htmlFor: id, textContent: p.symbol || p.key, title: `${p.name}: ${p.meaning}` });
  const element = make(
    "div",
    { className: "slider" },
    label,
    track,
    box,
    make("span", { className: "unit", textContent: p.unit }),
  );
  const mark = (v) => {
    element.classList.toggle("changed", p.submitted === undefined || v !== p.submitted);
    const [low, high] = p.usual;
    const unusual = (low !== null && v < low) || (high !== null && v > high);
    element.classList.toggle("unusual", unusual);
    box.title = unusual ? `outside the usual range, ${digits(low)} to ${digits(high)} ${p.unit}` : "";
  };
  mark(p.value);
  const set = (v, from) => {
    if (from !== range) range.value = Math.round(kSteps * place(p, v));
    if (from !== box) box.value = Number(digits(v, 5));
    range.setAttribute("aria-valuetext", digits(v) + " " + p.unit);
    mark(v);
  };
  range.addEventListener("input", () => {
    const v = Number(digits(value(p, range.value / kSteps), 5));
    set(v, range);
    moved(p.name, v);
  });
  range.addEventListener("change", () => settled(p.name));
  box.addEventListener("change", () => {
    const v = Number(box.value);
    if (box.value === "" || !Number.isFinite(v)) return set(p.value, null);
    set(v, box);
    moved(p.name, v);
    settled(p.name);
  });
  label.addEventListener("pointerenter", () => point(p.name));
  label.addEventListener("pointerleave", () => point(""));
  rows.set(p.name, { set, range });
  return element;
}

/**
 * Builds the sliders of a step. Calls `moved(name, value)` while a slider is dragged, `settled(name)` after that, and
 * `point(name)` when the pointer is at a name.
 */
export function build(step, moved, settled, point) {
  const focus = document.activeElement?.id;
  const open = new Map([...by("sliders").querySelectorAll("details")].map((d) => [d.dataset.block, d.open]));
  by("sliders").replaceChildren();
  rows.clear();
  const own = step.blocks.map((b) => b.name).reverse(); // added effects first
  for (const block of own) {
    const all = step.sliders.filter((p) => p.block === block);
    if (!all.length) continue;
    const group = make(
      "details",
      {},
      make("summary", { textContent: block, title: step.blocks.find((b) => b.name === block).title }),
    );
    group.dataset.block = block;
    group.open = open.get(block) ?? true;
    for (const p of all.filter((q) => q.fitted)) group.append(row(p, moved, settled, point));
    const rest = all.filter((q) => !q.fitted);
    if (rest.length) {
      const fold = make(
        "details",
        {},
        make("summary", { textContent: "not fitted: " + rest.map((p) => p.symbol || p.key).join(", ") }),
      );
      fold.dataset.block = block + "/rest";
      fold.open = open.get(fold.dataset.block) ?? false;
      fold.append(...rest.map((p) => row(p, moved, settled, point)));
      group.append(fold);
    }
    by("sliders").append(group);
  }
  if (focus) by(focus)?.focus({ preventScroll: true });
}
