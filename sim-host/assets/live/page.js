// The page of `shakedown live`: frames in, orders out. It keeps nothing that the program does not have.
"use strict";
(() => {
  const find = (id) => document.getElementById(id);
  const G = 9.80665;
  // For tests and for the curious: what this page has shown, and how many records came before its first frame.
  const seen = { frames: 0, samples: 0, before: 0, skipped: 0, missing: 0, redraws: 0, connected: false, status: null };
  window.live = seen;
  let facts = null;
  let traces = null;
  let plots = null;
  let dirty = false;
  let last = { frame: 0, message: -1 };
  let recent = [];

  const curves = {
    reference: { name: "reference", colour: "--faint", width: 1.4 },
    modified: { name: "after modification", colour: "--dashed", dash: [6, 4], width: 1.2 },
    achieved: { name: "achieved", colour: "--curve-0" },
  };

  function build() {
    const parent = find("charts");
    traces = new charts.Traces(6);
    const moving = { abscissa: "time in s", xRange: () => [traces.end - charts.WINDOW, traces.end], height: 190 };
    const spectral = { abscissa: "frequency in Hz", log: true, xRange: () => [0.4, 50], height: 190,
      ticks: (u, values) => values.map((v) => ([0.5, 1, 2, 5, 10, 20, 50].includes(v) ? v : "")) };
    const full = facts.full_opening ? "% of full opening" : "mm";
    const one = (name, colour) => [{ name, colour }];
    const powers = (u, values) => values.map((v) => (Math.abs(Math.log10(v) % 1) < 1e-9 ? v.toPrecision(1) : ""));
    plots = {
      displacement: charts.make(parent, { ...moving, title: "Displacement", unit: "mm", wide: true, height: 240,
        curves: [curves.reference, curves.modified, curves.achieved], range: charts.spared(2) }),
      error: charts.make(parent, { ...moving, title: "Error: reference less achieved", unit: "mm",
        curves: one("error", "--curve-1"), range: charts.spared(0.5) }),
      command: charts.make(parent, { ...moving, title: "Valve command; shaded: speed limit", unit: full,
        curves: one("command", "--curve-3"), range: charts.spared(4), draw: charts.shade(traces) }),
      acceleration: charts.make(parent, { ...moving, title: "Acceleration, measured", unit: "g",
        curves: one("achieved", "--curve-0"), range: charts.spared(0.05) }),
      spectrum: charts.make(parent, { ...spectral, title: "Spectrum of acceleration so far", unit: "m/s2/√Hz",
        curves: [curves.reference, curves.achieved], logY: true, yTicks: powers,
        range: (u, low, high) => [Math.max(low ?? 1e-3, (high ?? 1) * 1e-5) * 0.7, (high ?? 1) * 1.5] }),
      magnitude: charts.make(parent, { ...spectral, title: "Transfer function so far, magnitude", unit: "dB",
        curves: one("achieved by reference", "--curve-0"), range: charts.spared(6) }),
      phase: charts.make(parent, { ...spectral, title: "Transfer function so far, phase and coherence", unit: "degrees, %",
        curves: [{ name: "phase", colour: "--curve-0" }, { name: "coherence, %", colour: "--faint" }],
        range: () => [-180, 180], yTicks: (u, values) => values }),
    };
  }

  function take(frame) {
    if (last.frame && frame.frame > last.frame + 1) seen.skipped += frame.frame - last.frame - 1;
    if (frame.frame <= last.frame) return;
    if (!last.frame) seen.before = frame.status.samples - frame.time.length;
    last.frame = frame.frame;
    seen.frames += 1;
    seen.samples += frame.time.length;
    const scale = facts.full_opening ? 0.1 / facts.full_opening : 1;
    frame.time.forEach((time, i) => {
      const [r, m, x] = [frame.reference[i], frame.modified[i], frame.displacement[i]];
      const error = r == null || x == null ? null : r - x;
      const command = frame.command[i] == null ? null : scale * frame.command[i];
      const acceleration = frame.acceleration[i] == null ? null : frame.acceleration[i] / G;
      seen.missing += frame.gap[i];
      traces.add(time, [r, m, x, error, command, acceleration], frame.flags[i] & 1);
      recent.push([time, error ?? 0, frame.flags[i]]);
    });
    if (recent.length > 20000) recent = recent.slice(-10000);
    if (frame.spectra) spectra(frame.spectra);
    show(frame.status);
    dirty = true;
  }

  function spectra({ frequency, reference, achieved, magnitude, phase, coherence, segments }) {
    const positive = (y) => y.map((v) => (v > 0 ? v : null));
    plots.spectrum.setData([frequency, positive(reference), positive(achieved)]);
    plots.magnitude.setData([frequency, magnitude]);
    plots.phase.setData([frequency, phase, coherence.map((c) => (c == null ? null : 100 * c))]);
    seen.segments = segments;
  }

  // One redraw for everything that came since the last.
  function redraw() {
    requestAnimationFrame(redraw);
    if (!dirty || !plots) return;
    dirty = false;
    const { time, values } = traces;
    plots.displacement.setData([time, values[0], values[1], values[2]]);
    plots.error.setData([time, values[3]]);
    plots.command.setData([time, values[4]]);
    plots.acceleration.setData([time, values[5]]);
    tiles();
    seen.redraws += 1;
  }

  const WORDS = { off: "off: the relay is open", ready: "ready: the table is held", running: "running", hold: "held",
    "ramp-down": "fading out", tripped: "tripped" };

  function show(status) {
    seen.status = status;
    const state = find("state");
    const word = facts.kind === "recording" ? (status.phase === "running" ? "playing a recording" : "paused") : WORDS[status.state] ?? "not heard yet";
    const text = status.answers ? word + (status.cause && status.state === "tripped" ? `: ${status.cause}` : "") : "the device does not answer";
    if (state.textContent !== text) state.textContent = text;
    state.dataset.state = status.answers ? status.state ?? "" : "lost";
    if (status.message_number !== last.message) find("message").textContent = status.message;
    last.message = status.message_number;
    const recording = facts.kind === "recording";
    const enable = (id, on) => (find(id).disabled = !on);
    enable("arm", !recording && facts.has_test && status.phase === "idle" && ["off", "tripped"].includes(status.state));
    enable("start", status.phase === "armed" || (recording && status.phase === "held" && status.gone < status.total));
    enable("hold", status.phase === "running");
    find("gone").max = Math.max(status.total, 1);
    find("gone").value = status.gone;
  }

  const rounded = (value, digits) => (value == null || !Number.isFinite(value) ? "-" : value.toFixed(digits));

  function tiles() {
    const status = seen.status;
    const latest = (i) => {
      const y = traces.values[i];
      for (let k = y.length - 1; k >= 0; k--) if (y[k] != null) return y[k];
      return null;
    };
    let from = recent.length;
    while (from > 0 && recent[from - 1][0] > traces.end - 1) from--;
    const second = recent.slice(from);
    const rms = Math.sqrt(second.reduce((sum, [, e]) => sum + e * e, 0) / Math.max(second.length, 1));
    const at = second.filter(([, , flags]) => flags & 1).length / Math.max(second.length, 1);
    const lost = status.missing + seen.skipped;
    const unit = facts.full_opening ? "%" : "mm";
    const all = [
      ["achieved", rounded(latest(2), 2), "mm"],
      ["error, RMS of 1 s", rounded(rms, 2), "mm"],
      ["valve command", rounded(latest(4), 1), unit],
      ["at the speed limit, 1 s", rounded(100 * at, 0), "%", at > 0],
      ["records", String(status.samples), ""],
      ["records missing", String(status.missing), "", status.missing > 0],
      ["dropped by the device", String(status.dropped), "", status.dropped > 0],
      ["frames not shown here", String(seen.skipped), "", seen.skipped > 0],
      ["rows on disk", facts.recorded_in ? String(status.recorded) : "none", ""],
    ];
    const list = find("tiles");
    if (!list.children.length) {
      for (const [name] of all) {
        const tile = document.createElement("div");
        tile.append(document.createElement("dt"), document.createElement("dd"));
        tile.firstChild.textContent = name;
        list.append(tile);
      }
    }
    all.forEach(([, value, unit, bad], i) => {
      const tile = list.children[i];
      const text = unit ? `${value} ${unit}` : value;
      if (tile.lastChild.textContent !== text) tile.lastChild.textContent = text;
      tile.className = bad ? "bad" : "";
    });
    seen.lost = lost;
  }

  function alarm(text) {
    find("alarm").hidden = !text;
    find("alarm").textContent = text ?? "";
  }

  async function order(name, more = {}) {
    try {
      const answer = await fetch("order", {
        method: "POST",
        headers: { "content-type": "application/json" },
        body: JSON.stringify({ order: name, ...more }),
      });
      const outcome = await answer.json();
      if (!answer.ok) find("message").textContent = `${name} refused: ${outcome.refused}`;
      return answer.ok ? outcome : null;
    } catch {
      alarm(`The order ${name} did not reach the program. Stop at the bench, or with Ctrl-C in the terminal.`);
      return null;
    }
  }

  let confirming = null;
  function ask(number) {
    confirming = { number, until: Date.now() + 10000 };
    find("confirm").hidden = number == null;
    if (number != null) find("confirm-arm").focus();
    else confirming = null;
  }
  setInterval(() => {
    if (!confirming) return;
    const left = Math.ceil((confirming.until - Date.now()) / 1000);
    if (left <= 0) ask(null);
    find("confirm-left").textContent = `${left} s left`;
  }, 250);

  const acts = {
    arm: async () => {
      if (find("arm").disabled) return;
      const answer = await order("arm");
      if (answer) ask(answer.confirm);
    },
    confirm: () => {
      if (!confirming) return;
      const { number } = confirming;
      ask(null);
      order("confirm", { number });
    },
    start: () => find("start").disabled || order("start"),
    hold: () => find("hold").disabled || order("hold"),
    // Whatever the page believes, a stop and a trip are sent.
    stop: () => { ask(null); order("stop"); },
    trip: () => { ask(null); order("trip"); },
  };
  for (const name of ["arm", "start", "hold", "stop", "trip"]) find(name).addEventListener("click", acts[name]);
  find("confirm-arm").addEventListener("click", acts.confirm);
  find("confirm-not").addEventListener("click", acts.stop);
  const keys = { a: "arm", s: "start", h: "hold", t: "trip", escape: "stop" };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
    const act = keys[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    acts[act]();
  });

  async function begin() {
    facts = await (await fetch("facts")).json();
    find("source").textContent = `${facts.kind}: ${facts.name}`;
    document.title = `${facts.name} - shakedown live`;
    const parts = [`${facts.rate} samples a second`];
    if (facts.stroke) parts.push(`stroke ${(1e3 * facts.stroke).toFixed(0)} mm to either side`);
    if (facts.full_opening) parts.push(`valve fully open at a command of ${(1e3 * facts.full_opening).toFixed(1)} mm`);
    parts.push(facts.recorded_in ? `each test is recorded in ${facts.recorded_in}` : "tests are not recorded; give --out DIR");
    find("facts").textContent = `${parts.join("; ")}.`;
    build();
    const source = new EventSource("frames");
    source.onopen = () => { seen.connected = true; alarm(null); };
    source.onerror = () => {
      seen.connected = false;
      alarm("The program is not heard: this page no longer shows the bench. A streamed test fades out by itself within a second and the table is then held with the relay closed; stop at the bench, or with Ctrl-C in the terminal.");
    };
    source.onmessage = (event) => take(JSON.parse(event.data));
    requestAnimationFrame(redraw);
  }
  begin();
})();
