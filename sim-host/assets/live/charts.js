// Charts that move: the last seconds of the bench, and spectra as they come.
"use strict";
const charts = (() => {
  const WINDOW = 20;
  // A bucket is drawn as its smallest and its largest value, so that no spike is lost between pixels; it is a pixel or two wide.
  const BUCKET = 0.04;
  const KEPT = Math.round(WINDOW / BUCKET);
  const paint = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  // The last seconds of several channels, in buckets.
  class Traces {
    constructor(count) {
      this.count = count;
      this.time = [];
      this.values = Array.from({ length: count }, () => []);
      this.saturated = [];
      this.bucket = null;
    }

    add(time, values, saturated) {
      const number = Math.floor(time / BUCKET);
      if (number !== this.bucket) this.open(number);
      const last = this.time.length - 1;
      values.forEach((value, i) => {
        if (value == null || !Number.isFinite(value)) return;
        const y = this.values[i];
        if (y[last - 1] == null || value < y[last - 1]) y[last - 1] = value;
        if (y[last] == null || value > y[last]) y[last] = value;
      });
      if (saturated) this.saturated[this.saturated.length - 1] = true;
    }

    open(number) {
      // Buckets that were passed over are missing, not bridged.
      if (this.bucket != null && number > this.bucket + 1) this.push(this.bucket + 1);
      this.push(number);
      this.bucket = number;
      const over = this.time.length - 2 * KEPT;
      if (over > 0) [this.time, ...this.values].forEach((list) => list.splice(0, over));
      if (over > 0) this.saturated.splice(0, over / 2);
    }

    push(number) {
      this.time.push(number * BUCKET, (number + 0.5) * BUCKET);
      this.values.forEach((y) => y.push(null, null));
      this.saturated.push(false);
    }

    get end() {
      return this.time.length ? this.time[this.time.length - 1] : 0;
    }
  }

  const axis = (extra) => ({
    stroke: () => paint("--muted"),
    grid: { stroke: () => paint("--grid"), width: 1 },
    ticks: { stroke: () => paint("--axis"), width: 1, size: 4 },
    font: "12px system-ui, sans-serif",
    size: 54,
    ...extra,
  });

  const curve = ({ name, colour, dash, width }) => ({
    label: name,
    stroke: () => paint(colour),
    width: width ?? 1.6,
    dash,
    points: { show: false },
    spanGaps: false,
  });

  function figure(parent, { title, unit, abscissa, curves, wide }) {
    const element = document.createElement("figure");
    element.className = wide ? "wide" : "";
    element.setAttribute("role", "img");
    element.setAttribute("aria-label", `${title}, ${unit} over ${abscissa}: ${curves.map((c) => c.name).join(", ")}`);
    const caption = document.createElement("figcaption");
    caption.textContent = `${title} [${unit}]`;
    const legend = document.createElement("div");
    legend.className = "legend";
    for (const { name, colour, dash } of curves) {
      const entry = document.createElement("span");
      const mark = document.createElement("i");
      mark.className = dash ? "mark dashed" : "mark";
      mark.style.setProperty("--colour", `var(${colour})`);
      entry.append(mark, name);
      legend.append(entry);
    }
    const chart = document.createElement("div");
    chart.className = "chart";
    element.append(caption, legend, chart);
    parent.append(element);
    return chart;
  }

  // A range that does not jump: a tenth to spare, and no less than `least`.
  const spared = (least) => (u, low, high) => {
    if (low == null || high == null) return [-least, least];
    const spare = 0.1 * Math.max(high - low, least);
    const middle = (high + low) / 2;
    const half = Math.max((high - low) / 2 + spare, least / 2);
    return [middle - half, middle + half];
  };

  function make(parent, options) {
    const chart = figure(parent, options);
    const { curves, log, height, range, draw, xRange } = options;
    const plot = new uPlot(
      {
        width: chart.clientWidth || 600,
        height,
        legend: { show: false },
        cursor: { show: false },
        scales: {
          x: { time: false, distr: log ? 3 : 1, range: xRange },
          y: { distr: options.logY ? 3 : 1, range },
        },
        axes: [axis({ size: 30, values: options.ticks }), axis({ values: options.yTicks })],
        series: [{}, ...curves.map(curve)],
        hooks: draw ? { drawClear: [draw] } : {},
      },
      [[], ...curves.map(() => [])],
      chart,
    );
    new ResizeObserver(() => plot.setSize({ width: chart.clientWidth, height })).observe(chart);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plot.redraw(false, true));
    return plot;
  }

  // Marks the buckets in which the table was at its speed limit.
  const shade = (traces) => (u) => {
    const { ctx, bbox } = u;
    ctx.fillStyle = paint("--shade-0");
    traces.saturated.forEach((saturated, i) => {
      if (!saturated) return;
      const from = u.valToPos(traces.time[2 * i], "x", true);
      const to = u.valToPos(traces.time[2 * i] + BUCKET, "x", true);
      if (to >= bbox.left && from <= bbox.left + bbox.width) ctx.fillRect(from, bbox.top, to - from + 0.5, bbox.height);
    });
  };

  return { Traces, make, spared, shade, WINDOW };
})();
