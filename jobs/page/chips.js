// Chips (labels with the RMS error of each channel of each event), and the map of errors of one event.
import { by, digits, level, make, sign, times } from "./format.js";

/** Builds the chips. `state`: setup, step, first (the submitted step), event, channel, heldOut; `choose(event, channel)`. */
export function build(state, choose) {
  const { setup, step, first } = state;
  by("chips").replaceChildren(
    ...setup.events.map((event, e) => {
      const unseen = step.held_out.includes(event.name);
      const mark = unseen ? " (verification)" : state.heldOut.has(event.name) ? " (excluded from fits)" : "";
      const group = make(
        "div",
        { className: "group" + (e === state.event ? " now" : "") },
        make("span", { textContent: `event ${e + 1}${mark}`, title: `${event.name}: ${event.title}` }),
      );
      step.chips
        .filter((c) => c.event === e)
        .forEach((c) => {
          const before = first.chips.find((f) => f.event === e && f.name === c.name);
          const chip = make("button", {
            className: "chip " + level(c) + (e === state.event && c.channel === state.channel ? " chosen" : ""),
          });
          chip.dataset.event = e;
          chip.dataset.channel = c.channel;
          const moved = step.step !== first.step && before && times(before.ratio) !== times(c.ratio);
          chip.append(
            sign[level(c)] + " ",
            make("b", { textContent: c.name }),
            moved ? ` ${times(before.ratio).replace(" ×", "")} → ` : " ",
            make("span", { className: "ratio", textContent: times(c.ratio) }),
          );
          chip.title =
            `${event.name} ${c.name}: RMS error ${digits(c.rms)} ${c.unit}, ${times(c.ratio)} the noise` +
            (c.limit ? `; ${Math.round(100 * c.limit)} % of its limit` : "") +
            (unseen ? "; the fit has not seen this event" : "");
          chip.setAttribute(
            "aria-label",
            `event ${e + 1} ${c.name}: ${times(c.ratio)} noise, ${{ good: "only noise", warn: "more than noise", bad: "limit exceeded" }[level(c)]}`,
          );
          chip.addEventListener("click", () => choose(e, c.channel));
          group.append(chip);
        });
      return group;
    }),
  );
}
/** Shows the errors of a preview in an event's chips. */
export function moving(event, errors) {
  for (const chip of by("chips").querySelectorAll(`.chip[data-event="${event}"]`)) {
    const e = errors[chip.dataset.channel];
    chip.classList.remove(...Object.keys(sign));
    chip.classList.add("moving");
    chip.firstChild.textContent = "… ";
    chip.querySelector(".ratio").textContent = times(e.noise > 0 ? e.rms / e.noise : NaN);
  }
}

// Colours from blue to vermilion by the multiple of the noise bound. Colour-blind readers can distinguish them; a star
// marks values above the bound.
function shade(share) {
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  if (!(share > 1)) return dark ? "#16324a" : "#dcecf7";
  const strength = Math.min(1, Math.log10(share) / 2);
  return dark ? `hsl(24 75% ${20 + 24 * strength}%)` : `hsl(24 90% ${91 - 32 * strength}%)`;
}

/** Builds the map of one event; `zoom(channel, from, to)` shows a window. */
export function map(state, zoom) {
  const { setup, step, event } = state;
  const table = make(
    "table",
    {},
    make("tr", {}, make("th"), make("th"), ...setup.bands.map((b) => make("th", { textContent: b }))),
  );
  for (const c of step.chips.filter((x) => x.event === event)) {
    c.map.forEach((row, w) => {
      const tr = make(
        "tr",
        {},
        make("th", { textContent: w ? "" : c.name }),
        make("th", { textContent: row.window }),
      );
      row.bins.forEach((bin, b) => {
        if (!bin || bin[0] === null)
          return tr.append(
            make("td", { className: "none", textContent: "–", title: "the window is too short for this band" }),
          );
        const [ratio, bound, rms] = bin;
        const cell = make("button", { textContent: times(ratio) + (ratio > bound ? " ★" : "") });
        cell.style.background = shade(ratio / bound);
        const share = c.size > 0 ? `, ${digits((100 * rms) / c.size, 3)} % of ${digits(c.size)} ${c.unit}` : "";
        cell.title = `${c.name}, ${row.window}, ${setup.bands[b]}: RMS ${digits(rms)} ${c.unit}${share}; ${times(ratio)} the noise, limit ${times(bound)}`;
        cell.addEventListener("click", () => zoom(c.channel, row.from, row.to));
        tr.append(make("td", {}, cell));
      });
      table.append(tr);
    });
  }
  by("bins").replaceChildren(table);
}
