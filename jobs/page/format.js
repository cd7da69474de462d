// Formatting of numbers, and small functions for HTML elements.

/** Returns a number with three or four significant digits, without an exponent if possible. */
export function digits(v, n = 4) {
  if (v === null || v === undefined || !Number.isFinite(v)) return "–";
  const text = Number(v).toPrecision(n);
  return text.includes("e") ? text : String(Number(text));
}
/** Returns a ratio as "1.4 ×" or "86 ×". */
export function times(ratio) {
  if (ratio === null || !Number.isFinite(ratio)) return "–";
  return (ratio < 9.95 ? ratio.toFixed(1) : ratio.toFixed(0)) + " ×";
}
export function percent(p) {
  return p < 0.01 ? "< 1 %" : p > 0.99 ? "> 99 %" : Math.round(100 * p) + " %";
}
export const by = (id) => document.getElementById(id);
/** Creates an element with properties and children. */
export function make(tag, properties = {}, ...children) {
  const e = Object.assign(document.createElement(tag), properties);
  e.append(...children);
  return e;
}
/** Returns a channel's level: good (only noise), warn (more than noise, within limits), bad (exceeds a limit). */
export function level(chip) {
  if (chip.limit > 1) return "bad";
  return chip.bound > 1 && chip.judged ? "warn" : "good";
}
export const sign = { good: "✓", warn: "!", bad: "✗" };
