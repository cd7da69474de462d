// Charts of curves against time, shared by the live page and the reports.
/* exported curves */
const curves = (() => {
  /** Returns a colour of shared.css by its name. */
  const colour = (name) =>
    getComputedStyle(document.documentElement)
      .getPropertyValue("--" + name)
      .trim();

  /** Draws measured samples as points, at most one in two pixels, so that long records are drawn fast. */
  function points(u, i, from, to) {
    const path = new Path2D(),
      [x, y] = [u.data[0], u.data[i]];
    let last = [-9, -9];
    for (let k = from; k <= to; ++k) {
      if (y[k] === null || y[k] === undefined) continue;
      const at = [u.valToPos(x[k], "x", true), u.valToPos(y[k], "y", true)];
      if (Math.abs(at[0] - last[0]) < 2 && Math.abs(at[1] - last[1]) < 2) continue;
      path.moveTo(at[0], at[1]);
      path.lineTo(at[0] + 0.01, at[1]);
      last = at;
    }
    return { stroke: path, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  }
  const look = {
    measured: { width: 3.4, cap: "round", paths: points },
    ghost: { width: 1.5, dash: [6, 4] },
    model: { width: 1.6 },
    third: { width: 1.5, dash: [2, 3] },
    inferred: { width: 2 },
    limit: { width: 1, dash: [3, 3] },
  };

  /** Fills the times from..to over the height of the chart. */
  function band(u, from, to, fill) {
    const left = Math.max(u.valToPos(from, "x", true), u.bbox.left);
    const right = Math.min(u.valToPos(to, "x", true), u.bbox.left + u.bbox.width);
    if (right < left) return;
    u.ctx.save();
    u.ctx.fillStyle = fill;
    u.ctx.fillRect(left, u.bbox.top, Math.max(right - left, 1), u.bbox.height);
    u.ctx.restore();
  }
  /** Fills the values low..high over the width of the chart. */
  function level(u, low, high, fill) {
    const top = Math.max(u.valToPos(high, "y", true), u.bbox.top);
    const bottom = Math.min(u.valToPos(low, "y", true), u.bbox.top + u.bbox.height);
    if (bottom < top) return;
    u.ctx.save();
    u.ctx.fillStyle = fill;
    u.ctx.fillRect(u.bbox.left, top, u.bbox.width, Math.max(bottom - top, 1));
    u.ctx.restore();
  }
  /** Shades the failing window, the fault and the tolerance of `of` below the curves. */
  function shades(u, of) {
    if (of.tolerance) level(u, -of.tolerance, of.tolerance, colour("good-ground"));
    if (of.window) band(u, of.window[0], of.window[1], colour("shade"));
    if (of.fault) band(u, of.fault[0], of.fault[1], colour("fault"));
  }

  const text = (v, digits) => (v === null || v === undefined ? "–" : Number(v.toPrecision(digits)).toString());

  /**
   * Returns the options of uPlot. `of` contains the series {name, ink}, their unit, and the areas of shades(); it is
   * read at each drawing. below(u) draws further items below the curves.
   */
  function options(of, { width, height, title, group, below }) {
    const axis = {
      stroke: () => colour("soft"),
      grid: { stroke: () => colour("line"), width: 1 },
      ticks: { stroke: () => colour("line") },
    };
    const value = (u, v) => text(v, 5) + (v === null || v === undefined ? "" : " " + of.unit);
    return {
      title,
      width,
      height,
      cursor: { sync: { key: group }, drag: { x: true, y: false } },
      scales: { x: { time: false } },
      axes: [
        { ...axis, size: 34 },
        { ...axis, size: 56 },
      ],
      series: [
        { label: "t", value: (u, v) => (v === null || v === undefined ? "–" : v.toFixed(3) + " s") },
        ...of.series.map((s) => ({
          label: s.name,
          stroke: () => colour(s.ink),
          value,
          ...look[s.ink],
          points: { show: false },
        })),
      ],
      hooks: {
        drawClear: [
          (u) => {
            shades(u, of);
            below?.(u);
          },
        ],
      },
    };
  }
  return { colour, options };
})();
