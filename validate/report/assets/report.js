// Draws the charts of a report. Each figure contains its data; charts of a group zoom together.
/* global curves, uPlot */
(() => {
  const charts = [];
  let busy = false;

  /** Shows the same times in every chart of the group. */
  function follow(from) {
    if (busy) return;
    busy = true;
    const { min, max } = from.plot.scales.x;
    for (const c of charts) if (c !== from && c.of.group === from.of.group) c.plot.setScale("x", { min, max });
    busy = false;
  }
  const widest = document.querySelector("main");
  function width(box) {
    if (box.clientWidth) return box.clientWidth;
    const half = box.closest(".panels, .large") && innerWidth > 900; // in a closed part: its width when open
    const inner = widest.clientWidth - 2 * parseFloat(getComputedStyle(widest).paddingLeft);
    return half ? (inner - 18) / 2 : inner;
  }
  const height = (box) => parseInt(getComputedStyle(box).getPropertyValue("--height"), 10) || 220;

  /** Writes the displayed time range into the caption, unless all times are displayed. A printed chart needs it. */
  function caption(chart) {
    const { min, max } = chart.plot.scales.x;
    const t = chart.of.data[0];
    const all = min <= t[0] && max >= t.at(-1);
    const text = (v) => String(Number(v.toPrecision(4)));
    chart.box.closest("figure").querySelector(".part").textContent = all
      ? ""
      : `t = ${text(min)} to ${text(max)} s of ${text(t[0])} to ${text(t.at(-1))} s`;
  }

  function draw(box) {
    const of = JSON.parse(box.querySelector("script").textContent);
    const chart = { of, box };
    const options = curves.options(of, { width: width(box), height: height(box), group: of.group });
    options.legend = { live: true };
    options.cursor.sync.filters = { pub: (type) => type === "mousemove" || type === "mouseleave" };
    Object.assign(options.axes[0], { label: "t [s]", labelSize: 18, labelFont: "12px sans-serif", labelGap: 0 });
    options.hooks.setScale = [
      (u, key) => {
        if (key !== "x" || !chart.plot) return;
        caption(chart);
        follow(chart);
      },
    ];
    chart.plot = new uPlot(options, of.data, box);
    of.view ??= charts.find((c) => c.of.group === of.group)?.of.view; // the view of the group's other charts
    if (of.view) {
      busy = true;
      chart.plot.setScale("x", { min: of.view[0], max: of.view[1] });
      busy = false;
    }
    charts.push(chart);
  }
  function fit() {
    for (const c of charts)
      if (c.box.clientWidth && c.box.clientWidth !== c.plot.width)
        c.plot.setSize({ width: c.box.clientWidth, height: height(c.box) });
  }
  document.querySelectorAll(".chart").forEach(draw);
  addEventListener("resize", fit);
  document.querySelectorAll("details").forEach((d) => d.addEventListener("toggle", fit));

  /** Opens the folded parts around an element. */
  function reveal(element) {
    for (let e = element; e; e = e.parentElement) if (e.tagName === "DETAILS") e.open = true;
  }
  for (const link of document.querySelectorAll('a[href^="#"]'))
    link.addEventListener("click", () => reveal(document.getElementById(link.hash.slice(1))));

  // For printing, all parts are opened and the colours are light. Canvases are shrunk instead of redrawn where possible,
  // because a canvas that is drawn while printing makes a document of 100 MB.
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const redraw = () => charts.forEach((c) => c.plot.redraw(false));
  dark.addEventListener("change", redraw);
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details:not([open])")];
    opened.forEach((d) => (d.open = true));
    document.documentElement.classList.add("paper");
    if (dark.matches) redraw();
    for (const c of charts)
      c.box.style.zoom = Math.min(1, (c.box.closest(".panels, .large") ? 330 : 680) / c.plot.width);
  });
  addEventListener("afterprint", () => {
    opened.forEach((d) => (d.open = false));
    document.documentElement.classList.remove("paper");
    if (dark.matches) redraw();
    for (const c of charts) c.box.style.zoom = "";
  });
  /** The charts, for tests. */
  globalThis.charts_of_test = () => 
    charts.map((c) => ({ of: c.of, box: c.box, x: [c.plot.scales.x.min, c.plot.scales.x.max] }));
})();
