// Diagnosis and its candidates: progress, inferred inputs, probabilities, next measurement.
import { small } from "./charts.js";
import { by, digits, make, percent, times } from "./format.js";

let candidates = [];
export const best = () => candidates.find((c) => c.effect)?.effect;

export function busy(on) {
  by("stop").hidden = by("progress").hidden = !on;
  for (const id of ["diagnose", "fit"]) by(id).disabled = on;
  for (const b of document.querySelectorAll("#candidates button, #any button")) b.disabled = on;
  if (on) progress({ text: "Starting …" });
}
export function progress(message) {
  const share = /^(\d+) % done/.exec(message.text ?? "");
  const bar = by("progress").querySelector("progress");
  if (share) bar.value = Number(share[1]);
  else bar.removeAttribute("value");
  by("progress").querySelector("span").textContent = message.text;
}
/** Draws the decrease of the error: reduced chi-square of each better fit, on a logarithmic axis. */
const fall = [];
export function reached(message) {
  fall.push(message.chi2);
  if (fall.length < 2) return;
  const w = 360,
    h = 70,
    top = Math.log(Math.max(...fall)),
    bottom = Math.min(0, Math.log(Math.min(...fall)));
  const x = (k) => 8 + ((w - 80) * k) / Math.max(1, fall.length - 1),
    y = (v) => 10 + ((h - 20) * (top - Math.log(v))) / (top - bottom || 1);
  const points = fall.map((v, k) => `${x(k).toFixed(1)},${y(v).toFixed(1)}`).join(" ");
  by("fall").innerHTML =
    `<svg viewBox="0 0 ${w} ${h}" role="img" aria-label="fall of the error">` +
    `<polyline points="${points}" fill="none" stroke="currentColor" stroke-width="2"/><text x="${x(fall.length - 1) + 6}" y="${y(fall.at(-1)) + 4}">χ² ${digits(fall.at(-1), 3)}</text></svg>`;
}
/** Removes the drawing of the error. */
export function clearFall() {
  fall.length = 0;
  by("fall").replaceChildren();
}
/** Removes the results of the previous diagnosis. */
export function clear() {
  candidates = [];
  clearFall();
  by("said").textContent = "";
  for (const id of ["inputs", "candidates", "decide"]) by(id).replaceChildren();
}
function inputs(message, event) {
  const of = message.inputs?.find((i) => i.event === event) ?? message.inputs?.[0];
  if (!of || by("inputs").childElementCount) return;
  const side = message.side, unit = `, event ${of.event + 1}`;
  const show = (name, title) => {
    if (of[name]?.t?.length > 1) small(by("inputs"), title, of[name].t, of[name].value);
  };
  if (side !== "mechanical") show("field", `Missing field voltage [pu]${unit}`);
  if (side !== "excitation") show("torque", `Missing torque [pu]${unit}`);
}
/** Shows a preliminary or final result. `add(effect)`: function that adds a candidate to the model. */
export function result(message, event, add) {
  const final = message.type === "diagnosis";
  by("said").textContent = message.sentence;
  inputs(message, event);
  candidates = message.candidates ?? [];
  const shown = candidates.filter((c) => c.probability >= 0.01 || (!final && c.effect)).slice(0, 5);
  by("candidates").replaceChildren(
    ...shown.map((c) => {
      const fill = make("div", { className: "fill" });
      fill.style.width = Math.max(1, 100 * c.probability) + "%";
      const about = /\((.*)\)/.exec(c.what ?? "")?.[1] ?? c.what ?? "an effect that is not in the library";
      const item = make(
        "li",
        { title: c.chi2 ? `${c.what}: the fit has a reduced chi-square of ${digits(c.chi2, 3)} (1: noise)` : "" },
        make("span", { className: "share", textContent: final ? percent(c.probability) : "…" }),
        make("span", {}, c.name, make("small", { textContent: about })),
      );
      if (c.effect) {
        const button = make("button", { textContent: "Add and fit", disabled: !final });
        button.setAttribute("aria-label", `Add ${c.effect} and fit`);
        button.addEventListener("click", () => add(c.effect));
        item.append(button);
      }
      item.append(fill);
      return item;
    }),
  );
  by("decide").replaceChildren();
  if (message.next?.length) {
    by("decide").append(
      make("b", { textContent: "Possible next measurements: " }),
      message.next
        .slice(0, 3)
        .map((n) => `${n.what} (${digits(message.now, 2)} → ${digits(n.expected, 2)} candidates)`)
        .join("; "),
    );
  }
}
/** Returns a text about a finished fit: change of the error, changed parameters, held-out events, next action. */
export function summary(m, before, events) {
  const said = [
    m.ratio < before
      ? `${m.label}: the largest RMS / noise of all channels falls from ${times(before)} to ${times(m.ratio)}.`
      : `${m.label}: the largest RMS / noise of all channels does not fall (${times(before)} before, ${times(m.ratio)} after).`,
  ];
  const changed = m.sliders
    .filter((p) => p.submitted !== undefined && p.value !== p.submitted)
    .map((p) => ({ name: p.name, by: p.submitted ? (100 * (p.value - p.submitted)) / Math.abs(p.submitted) : NaN }))
    .sort((a, b) => Math.abs(b.by) - Math.abs(a.by));
  if (changed.length) {
    const most = changed.find((p) => Number.isFinite(p.by));
    const largest = most ? `, ${most.name} most (${most.by > 0 ? "+" : ""}${digits(most.by, 2)} %)` : "";
    said.push(`Changed parameters of the submitted model: ${changed.length}${largest}.`);
  }
  if (m.held_out.length) said.push(`Held out of this fit: ${m.held_out.join(", ")}.`);
  else if (m.kind === "added" && events > 1)
    said.push("To test the added effect on a held-out event: undo, tick “exclude from fits” at that event, and add the effect again.");
  if (m.kind === "added" && !m.evidence) said.push("The command at the bottom of the page also computes the evidence.");
  if (m.complete || m.fit) said.push("Save the model when you are satisfied.");
  return said.join(" ");
}
