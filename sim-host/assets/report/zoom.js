// What a figure shows of its abscissa. Figures of a group share one zoom and one cursor.
"use strict";
const zooms = (() => {
  const groups = new Map();
  const NOTHING = { left: 0, top: 0, width: 0, height: 0 };

  // The ends of the abscissa; a cloud or a loop gets a margin.
  function extent({ curves, loops, x: { log } }) {
    let low = Infinity, high = -Infinity;
    for (const { x, y } of curves) x.forEach((v, i) => {
      if (y[i] == null) return;
      low = Math.min(low, v);
      high = Math.max(high, v);
    });
    if (!(low <= high)) return log ? [1, 10] : [0, 1];
    if (low === high) return log ? [low / 2, high * 2] : [low - (Math.abs(low) || 1) / 2, high + (Math.abs(low) || 1) / 2];
    if (!loops || log) return [low, high];
    return uPlot.rangeNum(low, high, 0.05, false);
  }

  function create() {
    const members = [];
    let full = null;
    let now = null;

    // A group opens where the first of its figures says.
    const begin = (open) => {
      if (open && !begun) now = open;
      begun ||= open != null;
    };
    let begun = false;

    const show = () => {
      const [min, max] = now ?? full;
      for (const { u, element, y } of members) {
        element.classList.toggle("zoomed", now != null || y.now != null);
        u.setScale("x", { min, max });
      }
    };
    const to = (low, high) => {
      const [first, last] = full;
      now = low <= first && high >= last ? null : [Math.max(low, first), Math.min(high, last)];
      show();
    };
    const reset = () => {
      now = null;
      for (const member of members) member.y.now = null;
      show();
    };

    function select(u, y) {
      const { left, top, width, height } = u.select;
      if (width < 4 && height < 4) return;
      u.setSelect(NOTHING, false);
      const tall = height < u.over.clientHeight - 1 && height > 4;
      if (tall) y.now = [u.posToVal(top + height, "y"), u.posToVal(top, "y")];
      if (width > 4) to(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
      else show();
    }

    // Scales and moves the window by a share of its width, in the axis' own measure.
    function step(log, shrink, shift) {
      const into = log ? Math.log : (v) => v;
      const back = log ? Math.exp : (v) => v;
      const [a, b] = (now ?? full).map(into);
      const half = ((b - a) / 2) * shrink;
      const [first, last] = full.map(into);
      const wanted = (a + b) / 2 + shift * (b - a);
      const middle = Math.min(Math.max(wanted, first + half), Math.max(last - half, first + half));
      to(back(middle - half), back(middle + half));
    }

    function member(figure, element) {
      const [low, high] = extent(figure);
      full = full ? [Math.min(full[0], low), Math.max(full[1], high)] : [low, high];
      begin(figure.open);
      const y = { now: null };
      return {
        x: () => now ?? full,
        y: (auto) => (...given) => y.now ?? auto(...given),
        filters: { pub: (type) => type === "mousemove", sub: (type) => type === "mousemove" },
        hooks: { setSelect: [(u) => select(u, y)] },
        reset,
        step: (shrink, shift) => step(figure.x.log, shrink, shift),
        add: (u) => members.push({ u, element, y }),
        fit: () => show(),
      };
    }
    return { member };
  }

  // A zoom for this figure: its group's, or one of its own.
  function join(figure, element) {
    if (!figure.group) return create().member(figure, element);
    if (!groups.has(figure.group)) groups.set(figure.group, create());
    return groups.get(figure.group).member(figure, element);
  }
  return { join };
})();
