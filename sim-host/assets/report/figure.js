// A figure: reads the data block inside its element and draws it with uPlot.
"use strict";
const figures = (() => {
  const style = getComputedStyle(document.documentElement);
  const paint = (name) => style.getPropertyValue(name).trim();
  const CURVES = 7;
  const STEPS = 12;
  const SHADES = 3;
  const DEEPEST = 1e8;
  // Width of a figure that is folded away when it is made.
  const UNSEEN = 640;

  function abscissa({ from, step, count, skips, values }) {
    if (values) return values;
    if (count != null) return Array.from({ length: count }, (_, i) => from + step * i);
    let sum = 0;
    return skips.map((skip) => from + step * (sum += skip));
  }

  const rises = (x, strictly) => x.every((v, i) => i === 0 || (strictly ? x[i - 1] < v : x[i - 1] <= v));

  // The table uPlot wants for one curve: sorted by x.
  function sorted(x, y) {
    const order = x.map((_, i) => i).sort((a, b) => x[a] - x[b]);
    return [order.map((i) => x[i]), order.map((i) => y[i])];
  }

  // One abscissa for all curves. Values missing only because curves were joined are undefined, gaps are null.
  function align(curves) {
    const tables = curves.map((c) => (c.ordered ? [c.x, c.y] : sorted(c.x, c.y)));
    const same = curves.every((c) => c.ordered && c.x === curves[0].x);
    if (same) return [curves[0].x, ...curves.map((c) => c.y)];
    return tables.length === 1 ? tables[0] : uPlot.join(tables);
  }

  // Curves that turn back, and clouds of points, are drawn from their own samples.
  function pathOf(curve) {
    return (u) => {
      const path = new Path2D();
      const half = 1.8 * uPlot.pxRatio;
      const { left, top, width, height } = u.bbox;
      let pen = false;
      curve.x.forEach((x, i) => {
        const y = curve.y[i];
        if (y == null) return void (pen = false);
        const px = u.valToPos(x, "x", true);
        const py = u.valToPos(y, "y", true);
        if (curve.style !== "points") pen ? path.lineTo(px, py) : path.moveTo(px, py);
        else if (px >= left - half && px <= left + width + half && py >= top - half && py <= top + height + half) {
          path.moveTo(px + half, py);
          path.arc(px, py, half, 0, 2 * Math.PI);
        }
        pen = true;
      });
      const fill = curve.style === "points" ? path : null;
      return { stroke: fill ? null : path, fill, clip: null, band: null, gaps: null, flags: 0 };
    };
  }

  // Each name has one colour: the first dashed curve ink, the first faint one grey, all others the palette in turn, or,
  // where they are many, steps of a ramp.
  function colour(curves) {
    const keyOf = ({ style, name }) => `${style} ${name}`;
    const keys = [...new Set(curves.map(keyOf))];
    const first = (style) => keys.find((key) => key.startsWith(style));
    const [ink, grey] = [first("dashed"), first("faint")];
    const others = keys.filter((key) => key !== ink && key !== grey);
    const step = (i) => Math.round((i * (STEPS - 1)) / (others.length - 1));
    const chosen = (i) => (others.length <= CURVES ? `--curve-${i}` : `--ramp-${step(i)}`);
    const names = new Map([[ink, "--dashed"], [grey, "--faint"], ...others.map((key, i) => [key, chosen(i)])]);
    for (const curve of curves) curve.colour = names.get(keyOf(curve));
  }

  function read(element) {
    const data = JSON.parse(element.querySelector("script").textContent);
    const xs = data.abscissae.map(abscissa);
    const curves = data.series.map(({ name, style, x, y }) => {
      const ordered = rises(xs[x], data.abscissae.length > 1);
      return { name, style, x: xs[x], y, ordered, free: style === "points" || !ordered };
    });
    colour(curves);
    const labels = [...new Set((data.bands ?? []).map((b) => b.label))];
    const bands = (data.bands ?? []).map((b) => ({ ...b, shade: `--shade-${labels.indexOf(b.label) % SHADES}` }));
    const loops = curves.length > 0 && curves.every((c) => c.free);
    return { ...data, open: data.open ?? null, curves, bands, loops, table: curves.length ? align(curves) : [[]] };
  }

  function series(curve) {
    const stroke = () => paint(curve.colour);
    const faint = curve.style === "faint";
    return {
      label: curve.name,
      stroke,
      fill: curve.style === "points" ? stroke : undefined,
      alpha: faint ? 0.7 : curve.style === "points" ? 0.75 : 1,
      width: faint ? 1 : 1.6,
      dash: curve.style === "dashed" ? [6, 4] : undefined,
      points: { show: false },
      pxAlign: 0,
      ...(curve.free ? { paths: pathOf(curve) } : {}),
    };
  }

  // The sample under the cursor: the nearest one this curve has.
  function nearest(u, s, i) {
    const y = u.data[s];
    if (s === 0 || y[i] !== undefined) return i;
    let a = i, b = i;
    while (a >= 0 && y[a] === undefined) a--;
    while (b < y.length && y[b] === undefined) b++;
    if (a < 0) return b < y.length ? b : i;
    return b < y.length && u.data[0][b] - u.data[0][i] < u.data[0][i] - u.data[0][a] ? b : a;
  }

  function shade(u, bands) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.font = `${11 * uPlot.pxRatio}px ${paint("--sans")}`;
    ctx.textBaseline = "top";
    for (const band of bands) {
      const from = u.valToPos(Math.min(band.from, band.to), "x", true);
      const width = Math.max(u.valToPos(Math.max(band.from, band.to), "x", true) - from, uPlot.pxRatio);
      ctx.fillStyle = paint(band.shade);
      ctx.fillRect(from, bbox.top, width, bbox.height);
      const room = Math.min(from + width, bbox.left + bbox.width) - Math.max(from, bbox.left);
      if (ctx.measureText(band.label).width + 12 * uPlot.pxRatio < room) {
        ctx.fillStyle = paint("--muted");
        ctx.fillText(band.label, Math.max(from, bbox.left) + 6 * uPlot.pxRatio, bbox.top + 5 * uPlot.pxRatio);
      }
    }
    ctx.restore();
  }

  // A line at zero tells rest from motion.
  function zero(u) {
    const { min, max, distr } = u.scales.y;
    if (distr === 3 || !(min < 0 && max > 0)) return;
    const y = Math.round(u.valToPos(0, "y", true));
    u.ctx.fillStyle = paint("--axis");
    u.ctx.fillRect(u.bbox.left, y, u.bbox.width, Math.max(1, Math.round(uPlot.pxRatio)));
  }

  // Every whole step of every decade in sight, or, zoomed far in, the steps of a plain axis.
  function decades(u, _, low, high) {
    const splits = [];
    for (let p = Math.floor(Math.log10(low)); p <= Math.log10(high); p++)
      for (let k = 1; k < 10; k++) splits.push(Number(`${k}e${p}`));
    const inside = splits.filter((v) => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9));
    if (inside.length > 2) return inside;
    const step = 10 ** Math.floor(Math.log10((high - low) / 2));
    const first = Math.ceil(low / step);
    return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(6)));
  }

  // Of these ticks as many get a number as have room: all, then 1 2 5, then decades, then every so many.
  function numbered(side) {
    return (u, splits) => {
      const room = side === 2 ? 38 : 20;
      const place = (v) => u.valToPos(v, side === 2 ? "x" : "y");
      const roomy = (kept) => kept.every((v, i) => i === 0 || Math.abs(place(v) - place(kept[i - 1])) >= room);
      const front = (v) => v.toExponential()[0];
      const round = (v) => /^\de/.test(v.toExponential());
      const decade = (every) => (v) => round(v) && front(v) === "1" && Math.round(Math.log10(v)) % every === 0;
      const choices = [() => true, (v) => round(v) && "125".includes(front(v)), ...[1, 2, 3, 6].map(decade)];
      const chosen = choices.find((choice) => roomy(splits.filter(choice))) ?? (() => false);
      return splits.map((v) => (chosen(v) ? v : null));
    };
  }

  // The end of a logarithmic axis: a little further, then on to 1, 2 or 5 of its decade.
  function around(end, factor) {
    const v = end * factor;
    const decade = 10 ** Math.floor(Math.log10(v));
    const rungs = [1, 2, 5, 10].map((k) => k * decade);
    return factor > 1 ? rungs.find((r) => r >= v * (1 - 1e-9)) : rungs.findLast((r) => r <= v * (1 + 1e-9));
  }

  function axis(of, side) {
    const font = `11px ${paint("--sans")}`;
    const values = of.log
      ? (_, splits) => splits.map((v) => (v == null ? null : format.decade(v)))
      : (_, splits, __, ___, step) => splits.map((v) => format.tick(v, step));
    return {
      side, font, labelFont: `12px ${paint("--sans")}`, values,
      stroke: () => paint("--muted"),
      grid: { stroke: () => paint("--grid"), width: 1 },
      ticks: { show: false },
      gap: 6,
      ...(of.log ? { splits: decades, filter: numbered(side) } : {}),
      ...(side === 2
        ? { label: of.unit ? `${of.name} [${of.unit}]` : of.name, labelSize: 20, labelGap: 2, size: 26, space: 60 }
        : { size: (_, shown) => Math.max(50, 14 + 6.4 * Math.max(...(shown ?? []).map((v) => v?.length ?? 0))), space: 34 }),
    };
  }

  const height = (width, figure) => Math.round(Math.max(200, Math.min(figure.group ? 260 : 340, width * 0.6)));

  function options(element, figure, zoom) {
    const width = element.clientWidth || UNSEEN;
    // What is further below the largest value than any instrument reaches, as behind a filter, is not worth an axis.
    const floor = (low, high) => Math.max(low, high / DEEPEST);
    // One value alone stands in the middle.
    const apart = (low, high) => low === high ? [low - (Math.abs(low) || 1), high + (Math.abs(high) || 1)] : [low, high];
    const range = (log) => (_, low, high) => {
      if (low == null || !Number.isFinite(low)) return log ? [1, 10] : [0, 1];
      return log ? [around(floor(low, high), 1 / 1.05), around(high, 1.05)] : uPlot.rangeNum(...apart(low, high), 0.1, true);
    };
    return {
      width,
      height: height(width, figure),
      padding: [8, 12, 0, 0],
      legend: { show: false },
      scales: {
        x: { time: false, distr: figure.x.log ? 3 : 1, range: zoom.x },
        y: { distr: figure.y.log ? 3 : 1, range: zoom.y(range(figure.y.log)) },
      },
      series: [{}, ...figure.curves.map(series)],
      axes: [axis(figure.x, 2), axis(figure.y, 3)],
      cursor: {
        dataIdx: nearest,
        y: figure.loops,
        points: { size: 7, show: (_, s) => (figure.curves[s - 1].free ? null : document.createElement("div")) },
        bind: { dblclick: () => zoom.reset },
        drag: { x: true, y: figure.loops, setScale: false },
        ...(figure.group ? { sync: { key: figure.group, setSeries: false, scales: ["x", null], filters: zoom.filters } } : {}),
      },
      hooks: { drawClear: [(u) => shade(u, figure.bands)], drawAxes: [zero], ...zoom.hooks },
    };
  }

  return { read, options, height };
})();
