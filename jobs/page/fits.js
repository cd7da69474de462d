// Diagnosis and its candidates: progress, inferred inputs, probabilities, next measurement.
import { small } from "./charts.js";
import { by, digits, make, percent } from "./format.js";

let candidates = [];
export const best = () => candidates.find((c) => c.effect)?.effect;

export function busy(on) {
  by("stop").hidden = by("progress").hidden = !on;
  for (const id of ["diagnose", "fit"]) by(id).disabled = on;
  for (const b of document.querySelectorAll("#candidates button, #any button")) b.disabled = on;
  if (on) progress({ text: "starting" });
}
export function progress(message) {
  const share = /^(\d+) % done/.exec(message.text ?? "");
  const bar = by("progress").querySelector("progress");
  if (share) bar.value = Number(share[1]); else bar.removeAttribute("value");
  by("progress").querySelector("span").textContent = message.text;
}
export function clear() {
  candidates = [];
  by("said").textContent = "";
  for (const id of ["inputs", "candidates", "decide"]) by(id).replaceChildren();
}
function inputs(message, event, unit) {
  const of = message.inputs?.find((i) => i.event === event) ?? message.inputs?.[0];
  if (!of || by("inputs").childElementCount) return;
  const side = message.side;
  const show = (name, title) => {
    if (of[name]?.t?.length > 1) small(by("inputs"), title, of[name].t, of[name].value);
  };
  if (side !== "mechanical") show("field", `Missing field voltage [pu]${unit}`);
  if (side !== "excitation") show("torque", `Missing torque [pu]${unit}`);
}
/** Shows a preliminary or final result. `add(effect)` adds a candidate. */
export function result(message, event, add) {
  const final = message.type === "diagnosis";
  by("said").textContent = message.sentence;
  inputs(message, event, `, event ${event + 1}`);
  candidates = message.candidates ?? [];
  by("candidates").replaceChildren(...candidates.filter((c) => c.probability >= 0.005 || c.effect).slice(0, 6).map((c) => {
    const fill = make("div", { className: "fill" });
    fill.style.width = Math.max(1, 100 * c.probability) + "%";
    const item = make("li", {}, make("span", { className: "share", textContent: percent(c.probability) }),
      make("span", {}, c.name, make("small", { textContent: c.what ? `${c.what}${c.chi2 ? `; leaves χ² ${digits(c.chi2, 3)} per value` : ""}` : "" })));
    if (c.effect) {
      const button = make("button", { textContent: "Add and fit", disabled: !final });
      button.setAttribute("aria-label", `Add ${c.effect} and fit`);
      button.addEventListener("click", () => add(c.effect));
      item.append(button);
    }
    item.append(fill);
    return item;
  }));
  by("decide").replaceChildren();
  if (message.next?.length) {
    by("decide").append(make("b", { textContent: "Which measurement would decide: " }),
      message.next.slice(0, 3).map((n) => `${n.what} (${digits(message.now, 2)} → ${digits(n.expected, 2)} candidates)`).join("; "));
  }
}
