// Brings the page to life: figures with their legends, tables that sort, colours that follow the reader's setting.
"use strict";
(() => {
  const drawn = [];
  const HINT = matchMedia("(hover: hover)").matches ? "drag to zoom" : "";

  function element(tag, properties, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  }

  const withUnit = (text, unit) => (unit && text !== "–" ? `${text} ${unit}` : text);

  // One button for each name; curves of one name hide together.
  function legend(figure) {
    const list = element("div", { className: "legend" });
    const entries = [];
    figure.curves.forEach((curve, i) => {
      const known = entries.find((e) => e.name === curve.name && e.style === curve.style);
      if (known) return void known.members.push(i + 1);
      if (!curve.name) return;
      const value = element("output", { className: "value" });
      const mark = element("span", { className: `mark ${curve.style}` });
      mark.style.setProperty("--colour", `var(${curve.colour})`);
      const button = element("button", { type: "button", title: "Hide or show" }, mark, curve.name, value);
      button.setAttribute("aria-pressed", "true");
      list.append(button);
      entries.push({ name: curve.name, style: curve.style, members: [i + 1], button, value });
    });
    for (const label of new Set(figure.bands.map((b) => b.label).filter(Boolean))) {
      const mark = element("span", { className: "mark band" });
      mark.style.setProperty("--colour", `var(${figure.bands.find((b) => b.label === label).shade})`);
      list.append(element("span", { className: "band-name" }, mark, label));
    }
    return { list, entries };
  }

  function readout(figure, entries, place) {
    return (u) => {
      const i = u.cursor.left >= 0 ? u.cursor.idx : null;
      place.textContent = i == null ? HINT : `${figure.x.name} ${withUnit(format.value(u.data[0][i]), figure.x.unit)}`;
      for (const { members, value } of entries) {
        const [s] = members;
        const at = u.cursor.idxs?.[s];
        const shown = i != null && at != null && u.series[s].show && !figure.curves[s - 1].free;
        value.textContent = shown ? withUnit(format.value(u.data[s][at]), figure.y.unit) : "";
      }
    };
  }

  function keys(zoom) {
    const moves = {
      ArrowLeft: [1, -0.2], ArrowRight: [1, 0.2], "+": [0.6, 0], "=": [0.6, 0], "-": [1 / 0.6, 0],
    };
    return (event) => {
      if (event.target !== event.currentTarget || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === "Escape" || event.key === "0") zoom.reset();
      else if (moves[event.key]) zoom.step(...moves[event.key]);
      else return;
      event.preventDefault();
    };
  }

  function prepare(host) {
    const figure = figures.read(host);
    const zoom = zooms.join(figure, host);
    const { list, entries } = legend(figure);
    const place = element("output", { className: "place", textContent: HINT });
    const back = element("button", { type: "button", className: "back", onclick: zoom.reset }, "Show all");
    const name = figure.y.unit ? `${figure.y.name} [${figure.y.unit}]` : figure.y.name;
    const chart = element("div", { className: "chart" });
    list.append(place, back);
    host.querySelector("script").after(list, element("p", { className: "ordinate" }, name), chart);
    return { host, figure, zoom, entries, place, chart };
  }

  function draw({ host, figure, zoom, entries, place, chart }) {
    if (!figure.curves.some((c) => c.y.some((v) => v != null))) {
      chart.replaceWith(element("p", { className: "empty" }, "No data to draw."));
      return;
    }
    const options = figures.options(chart, figure, zoom);
    options.hooks.setCursor = [readout(figure, entries, place)];
    const u = new uPlot(options, figure.table, chart);
    u.root.setAttribute("aria-hidden", "true");
    zoom.add(u);
    if (figure.open) zoom.fit();
    for (const { button, members } of entries) {
      button.onclick = () => {
        const show = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(show));
        for (const s of members) u.setSeries(s, { show });
      };
    }
    host.addEventListener("keydown", keys(zoom));
    let last = chart.clientWidth;
    const fit = (width) => {
      if (!width || width === last) return;
      last = width;
      u.setSize({ width, height: figures.height(width, figure) });
    };
    new ResizeObserver(([entry]) => fit(Math.round(entry.contentRect.width))).observe(chart);
    drawn.push({ u, fit, chart });
  }

  // A cell's number, a typographic minus included; words sort behind.
  function key(cell) {
    const text = cell.textContent.trim().replace("−", "-").replace(/^[<>≤≥~]\s*/, "");
    const number = Number.parseFloat(text);
    return Number.isNaN(number) ? text : number;
  }

  function compare(a, b) {
    if (typeof a === typeof b) return typeof a === "number" ? a - b : a.localeCompare(b);
    return typeof a === "number" ? -1 : 1;
  }

  function sortable(table) {
    const body = table.tBodies[0];
    const rows = [...body.rows];
    if (rows.length < 3) return;
    const heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => {
      const button = element("button", { type: "button", title: "Sort" }, ...head.childNodes);
      head.append(button);
      button.onclick = () => {
        const order = { none: "descending", descending: "ascending", ascending: "none" };
        const next = order[head.ariaSort ?? "none"];
        for (const other of heads) other.ariaSort = "none";
        head.ariaSort = next;
        const sign = next === "descending" ? -1 : 1;
        const sorted = [...rows].sort((a, b) => sign * compare(key(a.cells[column]), key(b.cells[column])));
        body.append(...(next === "none" ? rows : sorted));
      };
    });
  }

  const recolour = () => drawn.forEach(({ u }) => u.redraw(false));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  // A link into what is folded unfolds it.
  const unfold = () => {
    const aim = location.hash && document.querySelector(location.hash);
    if (aim instanceof HTMLDetailsElement) aim.open = true;
  };
  addEventListener("hashchange", unfold);
  unfold();
  addEventListener("beforeprint", () => {
    document.querySelectorAll("details").forEach((d) => { d.open = true; });
    document.documentElement.dataset.print = "";
    drawn.forEach(({ u, fit }) => { fit(660); u.redraw(false); });
  });
  addEventListener("afterprint", () => {
    delete document.documentElement.dataset.print;
    drawn.forEach(({ u, fit, chart }) => { fit(chart.clientWidth); u.redraw(false); });
  });

  // All join their groups before the first is drawn, so that a group's figures start with the same abscissa.
  [...document.querySelectorAll("figure")].map(prepare).forEach(draw);
  document.querySelectorAll("table:not(.matrix)").forEach(sortable);
})();
