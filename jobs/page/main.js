// The live page: its state and its actions.
import * as api from "./api.js";
import * as charts from "./charts.js";
import * as chips from "./chips.js";
import * as fits from "./fits.js";
import { by, digits, level, make, times } from "./format.js";
import * as sliders from "./sliders.js";

const state = {
  setup: null,
  step: null,
  first: null,
  event: 0,
  channel: 0,
  heldOut: new Set(),
  past: [],
  future: [],
  known: new Map(),
  base: 0,
  values: {},
  curves: new Map(),
  running: null,
  starting: null, // request that starts the fit
  number: 0,
  trying: null, // running comparison after a value was changed
  diagnosed: null, // step of the diagnosis whose candidates are shown
};

function fail(error) {
  by("failure").textContent = error.message ?? String(error);
  by("failure").hidden = false;
}
const guard =
  (action) =>
  async (...words) => {
    by("failure").hidden = true;
    try {
      return await action(...words);
    } catch (error) {
      fail(error);
    }
  };

async function curvesOf(k, e) {
  const key = k + "/" + e;
  if (!state.curves.has(key)) {
    if (state.curves.size > 40) state.curves.delete(state.curves.keys().next().value);
    const count = state.first.chips.filter((c) => c.event === e).length;
    state.curves.set(key, charts.split(await api.curves(k, e), count));
  }
  return state.curves.get(key);
}
const chipsOf = (step, e) => step.chips.filter((c) => c.event === e);
const windowOf = (chip) => {
  const row = level(chip) !== "good" && chip.map[chip.window];
  return row ? [row.from, row.to] : null;
};
const windows = () => chipsOf(state.step, state.event).map(windowOf);

/** Returns the measured curve minus and plus the maximum error (MXE) allowed before, during and after the fault. */
function allowed(largest, times_, t, measured) {
  if (!largest || !times_.length) return null;
  const size = t.map((at) => largest[at < times_[0] ? 0 : at <= times_.at(-1) ? 1 : 2]);
  return [measured.map((v, k) => v - size[k]), measured.map((v, k) => v + size[k])];
}

/** Writes the largest half width of the 95 % bands of P and Q, because a band is often narrower than a line. */
function showBandSize(own, channels) {
  by("band-size").textContent = own
    .slice(0, 2)
    .flatMap((c, k) => (channels[k].band ? `${c.name} ± ${digits(channels[k].widest, 2)} ${c.unit}` : []))
    .join(", ");
}
/** Shows the event's curves of the current step. */
async function showEvent() {
  const { event: e, step } = state;
  const [ghost, now] = [await curvesOf(0, e), await curvesOf(step.step, e)];
  const own = chipsOf(step, e),
    times_ = step.switchings[e];
  charts.show(
    own.map((c, k) => ({
      name: c.name,
      unit: c.unit,
      main: k < 2,
      window: windowOf(c),
      fault: times_.length > 1 ? [times_[0], times_.at(-1)] : null,
      allowed: allowed(c.allowed, times_, now.t, now.channels[k].measured),
      band: now.channels[k].band,
      data: [now.t, now.channels[k].measured, ghost.channels[k].modelled, now.channels[k].modelled],
    })),
  );
  showBandSize(own, now.channels);
  near();
  charts.choose(state.channel);
  by("hold").checked = state.heldOut.has(state.setup.events[e].name);
  const about = state.setup.events[e];
  by("title").textContent = `Event ${e + 1}: ${about.title}`;
  by("notes").hidden = !about.notes.length;
  by("notes")
    .querySelector("ul")
    .replaceChildren(...about.notes.map((n) => make("li", { textContent: n })));
}
function near() {
  const at = state.step.switchings[state.event];
  if (at.length) charts.zoom(at[0] - 1, at.at(-1) + 5);
  else charts.zoom();
}

/** Shows one window of one channel, with a margin of a fifth of the window on both sides. */
function enlarge(channel, from, to) {
  const margin = 0.2 * (to - from);
  charts.zoom(from - margin, to + margin);
  state.channel = channel;
  charts.choose(channel);
  charts.shade(chipsOf(state.step, state.event).map((c) => (c.channel === channel ? [from, to] : null)));
  chips.build(state, guard(choose));
  by("charts").scrollIntoView({ block: "nearest" });
}

const about = (s) => [
  ...(s.evidence ? [`evidence ${Math.round(s.evidence).toLocaleString("en")}`] : []),
  ...(s.held_out.length ? [`held out: ${s.held_out.join(", ")}`] : []),
];
function showSteps() {
  const shown = [...state.known.values()].filter((s) => s.kind !== "manual" || s.step === state.step.step);
  by("steps").replaceChildren(
    ...shown.map((s) => {
      const b = make(
        "button",
        {},
        make("span", {}, s.label, make("small", { textContent: about(s).join("; ") })),
        make("span", {
          className: "error",
          textContent: times(s.ratio) + " noise",
          title: "largest RMS / noise of all channels",
        }),
      );
      b.addEventListener(
        "click",
        guard(() => goTo(s.step)),
      );
      return make("li", { className: s.step === state.step.step ? "now" : "" }, b);
    }),
  );
  by("undo").disabled = !state.past.length;
  by("redo").disabled = !state.future.length;
}
/** Shows a command line. If it contains `model.toml`, the model has to be saved first. */
function showCommand(text) {
  by("command").textContent = text;
  by("first").hidden = !/ --model model\.toml\b/.test(text);
}
function showStep() {
  const { step } = state;
  by("verdict").textContent = step.verdict;
  by("verdict").className = step.complete && step.fit ? "good" : step.fit || step.complete ? "warn" : "bad";
  by("reason").textContent = step.sentence || step.reason;
  showCommand(step.command);
  by("save").classList.toggle("primary", step.step > 0 && (step.complete || step.fit));
  by("band").hidden = !step.bands;
  by("now").textContent = step.step ? `this model: ${step.label}` : "this model (as submitted)";
  chips.build(state, guard(choose));
  chips.map(state, enlarge);
  sliders.build(step, moved, settled, point);
  showSteps();
  api
    .effects(step.step)
    .then((all) =>
      by("effects").replaceChildren(...all.map((h) => make("option", { value: h.name, label: h.what }))),
    );
}

/** Makes a step the current one and animates the shown curves into the curves of this step. */
async function enter(step, keepPast = false) {
  if (!keepPast) {
    state.past.push(state.step.step);
    state.future = [];
  }
  state.known.set(step.step, step);
  state.step = step;
  sessionStorage.setItem("step", step.step);
  state.base = step.kind === "manual" ? step.parent : step.step;
  const base = state.known.get(state.base) ?? step;
  state.values = {};
  for (const p of step.sliders) {
    const before = base.sliders.find((q) => q.name === p.name);
    if (before && before.value !== p.value) state.values[p.name] = p.value;
  }
  showStep();
  const now = await curvesOf(step.step, state.event);
  showBandSize(chipsOf(step, state.event), now.channels);
  if (state.step === step)
    charts.animate(
      now.channels.map((c) => c.modelled),
      () => {
        charts.bands(now.channels.map((c) => c.band));
        charts.shade(windows());
      },
    );
}
async function goTo(k) {
  if (k === state.step.step) return;
  await enter(await api.step(k));
}
async function walk(from, to) {
  while (from.length) {
    const k = from.pop();
    try {
      const step = await api.step(k);
      to.push(state.step.step);
      return await enter(step, true);
    } catch {
      state.known.delete(k);
    } // an old manual change that the server has dropped
  }
}
async function choose(event, channel = 0) {
  state.event = event;
  state.channel = channel;
  chips.build(state, guard(choose));
  chips.map(state, enlarge);
  await showEvent();
}
function hold(event, on) {
  const { name } = state.setup.events[event];
  if (on) state.heldOut.add(name);
  else state.heldOut.delete(name);
  if (state.heldOut.size >= state.setup.events.length) {
    state.heldOut.delete(name);
    fail(new Error("Every event would be held out: a fit needs at least one."));
  }
  sessionStorage.setItem("heldOut", JSON.stringify([...state.heldOut]));
  by("hold").checked = state.heldOut.has(state.setup.events[state.event].name);
  chips.build(state, guard(choose));
}

// --- sliders: one preview is computed at a time; a newer value replaces a waiting one
let flying = false,
  waiting = false;
async function fly() {
  if (flying) {
    waiting = true;
    return;
  }
  flying = true;
  const number = ++state.number,
    event = state.event;
  const begin = performance.now();
  try {
    const samples = await api.preview({ seq: number, step: state.base, event, values: state.values });
    if (samples && event === state.event && number === state.number) {
      const n = chipsOf(state.step, event).length,
        size = samples.length / n;
      const parts = Array.from({ length: n }, (_, k) => samples.subarray(k * size, (k + 1) * size));
      charts.model(parts.map((p) => p.subarray(2)));
      chips.moving(
        event,
        parts.map((p) => ({ rms: p[0], noise: p[1] })),
      );
      by("charts").dataset.answered = (performance.now() - begin).toFixed(1);
    }
  } catch (error) {
    fail(error);
  }
  flying = false;
  if (waiting) {
    waiting = false;
    fly();
  }
}
/** Shows the effect of ± 10 % of a parameter while the pointer is at it. */
let pointed = "";
const point = guard(async (name) => {
  pointed = name;
  by("ribbon").hidden = !name;
  by("ribbon").lastElementChild.textContent = `${name} ± 10 %`;
  if (!name) return charts.ribbon(null);
  const { event } = state,
    n = chipsOf(state.step, event).length;
  const samples = await api.ribbon({ step: state.base, event, values: state.values, name });
  if (pointed !== name || event !== state.event) return;
  const size = samples.length / (2 * n);
  charts.ribbon(
    Array.from({ length: n }, (_, k) => [
      samples.subarray(2 * k * size, (2 * k + 1) * size),
      samples.subarray((2 * k + 1) * size, (2 * k + 2) * size),
    ]),
  );
});
function moved(name, value) {
  state.values[name] = value;
  by("verdict").textContent = "Trying …";
  by("verdict").className = "";
  by("reason").textContent = "The curves of this event change while you drag. All events are compared when you let go.";
  fly();
}
async function compareChanged() {
  const number = ++state.number; // stale previews are dropped
  try {
    const step = await api.change({ step: state.base, values: state.values });
    if (number === state.number && step.step !== state.step.step) await enter(step);
    else if (number === state.number) showStep();
  } catch (error) {
    showStep();
    await showEvent();
    throw error;
  }
}
const settled = guard(() => (state.trying = compareChanged()));
/** Returns an action on the current step. It waits for earlier actions and for the comparison of a changed value. */
let before = Promise.resolve();
const onStep = (action) => {
  const guarded = guard(async (...words) => {
    await state.trying?.catch(() => {}); // settled() shows this error
    return action(...words);
  });
  return (...words) => (before = before.then(() => guarded(...words)));
};

// --- fits
async function start(request) {
  const held = [...state.heldOut];
  fits.clearFall();
  if (request.kind === "diagnose") {
    fits.clear();
    state.diagnosed = state.step.step;
    showCommand(`swingbank diagnose --model ${state.step.step ? "model.toml" : state.setup.file}${state.setup.options}`);
  }
  fits.busy(true);
  try {
    state.starting = api.fit({ ...request, step: state.step.step, held_out: held });
    await state.starting;
    state.running = request.kind;
  } catch (error) {
    fits.busy(false);
    throw error;
  }
}
const add = onStep((effect) => start({ kind: "add", effect }));
/** Adds a candidate to the diagnosed model, which may differ from the current one. */
const addCandidate = onStep(async (effect) => {
  if (state.diagnosed !== null && state.diagnosed !== state.step.step) await goTo(state.diagnosed);
  await start({ kind: "add", effect });
});
const receive = guard(async (m) => {
  if (m.type === "progress") return fits.progress(m);
  if (m.type === "reached") {
    fits.reached(m);
    const own = chipsOf(state.step, state.event),
      event = m.events.find((e) => e.event === state.event);
    if (event?.channels.length === own.length)
      charts.animate(event.channels.map((c, k) => Float32Array.from(c, (v) => v * own[k].scale)));
    return undefined;
  }
  if (m.type === "preliminary" || m.type === "diagnosis") return fits.result(m, state.event, addCandidate);
  fits.busy(false);
  state.running = null;
  if (m.type === "step") {
    const before = state.step.ratio;
    fits.clearFall();
    await enter(m);
    by("said").textContent = fits.summary(m, before, state.setup.events.length);
    if (innerWidth < 700) by("verdict").scrollIntoView({ block: "start" });
  }
  if (m.type === "failed") by("said").textContent = m.text;
});

const save = onStep(async () => {
  const { step } = state;
  const saved = await api.save(step.step);
  by("saved").replaceChildren(
    `Saved “${step.label}” (${times(step.ratio)} noise)${saved.replaced ? ", replacing the existing files" : ""}: `,
    saved.files.join(", "),
    ". Check it: ",
    make("code", { textContent: saved.command }),
    ...saved.notes.map((n) => make("small", { textContent: n })),
  );
  showCommand(saved.command);
});
const undo = onStep(() => walk(state.past, state.future));
const redo = onStep(() => walk(state.future, state.past));

const actions = {
  d: () => by("diagnose").click(),
  f: () => by("fit").click(),
  a: () => fits.best() && addCandidate(fits.best()),
  z: undo,
  y: redo,
  s: save,
  h: () => hold(state.event, !state.heldOut.has(state.setup.events[state.event].name)),
  Escape: () => by("stop").click(),
};
document.addEventListener("keydown", (k) => {
  const typing = k.target.matches?.("input:not([type=range]):not([type=checkbox])");
  if (typing || k.altKey || k.metaKey || (k.ctrlKey && !"zy".includes(k.key))) return;
  if (/^[1-9]$/.test(k.key) && Number(k.key) <= state.setup.events.length)
    return void guard(choose)(Number(k.key) - 1);
  if (actions[k.key]) {
    k.preventDefault();
    actions[k.key]();
  }
});
by("diagnose").addEventListener(
  "click",
  onStep(() => start({ kind: "diagnose" })),
);
by("fit").addEventListener(
  "click",
  onStep(() => start({ kind: "calibrate" })),
);
by("stop").addEventListener(
  "click",
  guard(async () => {
    await state.starting?.catch(() => {}); // start() shows this error
    if (state.running) await api.stop();
  }),
);
by("undo").addEventListener("click", undo);
by("redo").addEventListener("click", redo);
by("save").addEventListener("click", save);
by("hold").addEventListener("change", () => hold(state.event, by("hold").checked));
by("near").addEventListener("click", near);
by("whole").addEventListener("click", () => charts.zoom());
by("copy").addEventListener("click", () => navigator.clipboard.writeText(by("command").textContent));
by("any").addEventListener("submit", (e) => {
  e.preventDefault();
  const effect = by("effect").value.trim();
  if (effect) add(effect);
  else fail(new Error("Write the name of an effect, for example SEXS."));
});
addEventListener("pagehide", () => {
  if (state.running) api.leave();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener(
  "change",
  guard(() => choose(state.event, state.channel)),
);

function lost(error) {
  if (state.running) fits.busy(false);
  state.running = null;
  by("said").textContent = error.message;
  fail(error);
}
/** Restores the step and the held-out events of this tab after a reload. */
async function restore(steps) {
  for (const name of JSON.parse(sessionStorage.getItem("heldOut") ?? "[]"))
    if (state.setup.events.some((e) => e.name === name)) state.heldOut.add(name);
  if (state.heldOut.size) await choose(state.event, state.channel);
  const last = steps.find((s) => String(s.step) === sessionStorage.getItem("step"));
  if (last) await enter(last);
}
/** Replaces the provisional comparison by the comparison with fitted switching times. */
async function compareSubmitted() {
  const full = await api.submitted();
  state.setup = full.setup;
  state.first = full.step;
  state.known.set(0, full.step);
  state.curves.clear();
  if (state.step.step !== 0) return;
  state.step = full.step;
  showStep();
  await showEvent();
}
async function begin() {
  const opened = await api.open();
  state.setup = opened.setup;
  state.step = state.first = opened.step;
  for (const s of [opened.step, ...opened.steps]) state.known.set(s.step, s);
  by("plant").textContent = state.setup.name;
  by("subject").textContent = `${state.setup.subject}, ${digits(state.setup.mva)} MVA · limits ${state.setup.limits}`;
  document.title = `${state.setup.name} – Swingbank`;
    // Show the worst event first; the limits concern the channels P and Q.
  const judged = state.step.chips.filter((c) => c.judged && c.channel < 2);
  const worst = judged.reduce((a, b) => ((b.ratio ?? 0) > (a.ratio ?? 0) ? b : a), judged[0]);
  state.event = worst?.event ?? 0;
  state.channel = worst?.channel ?? 0;
  showStep();
  await showEvent();
  api.listen(receive, lost);
  document.body.dataset.ready = "yes";
  if (state.step.provisional) await compareSubmitted();
  await restore(opened.steps);
  document.body.dataset.compared = "yes";
}
begin().catch((error) => {
  by("verdict").textContent = "The model cannot be compared";
  by("verdict").className = "bad";
  by("reason").textContent = error.message;
});
