// The page around the worker: what was dropped becomes a command line, what comes back is shown.
"use strict";

const $ = (selector, within = document) => within.querySelector(selector);
const $$ = (selector, within = document) => [...within.querySelectorAll(selector)];
const CONTROLLERS = ["current", "strong", "acc-disp", "acc-disp-2", "velo-disp", "velo-disp-acc", "velo-acc", "modified", "tracking"];

// A worker at work on one run; another run, or Cancel, ends it: what computes cannot be told anything.
class Tool {
  #module = null;
  #worker = null;
  #end = null;
  #id = 0;

  // The program, unpacked and compiled once for all workers.
  async #ready() {
    const packed = Uint8Array.from(atob($("#program").textContent.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
  }

  async #begin() {
    this.#module ??= this.#ready();
    const source = new Blob([$("#worker").textContent], { type: "text/javascript" });
    const address = URL.createObjectURL(source);
    const worker = new Worker(address);
    URL.revokeObjectURL(address);
    worker.postMessage({ module: await this.#module });
    return worker;
  }

  get busy() {
    return this.#end !== null;
  }

  // Ends what is under way.
  cancel() {
    this.#worker?.then((worker) => worker.terminate());
    this.#worker = null;
    this.#end?.(new Error("cancelled"));
  }

  // One run of the command line with these words and files: its status, its words, and the files that are wanted of it.
  async run(args, files, wanted, hear = () => {}) {
    if (this.busy) this.cancel();
    this.#worker ??= this.#begin();
    const begun = this.#worker;
    const ended = new Promise((_, refuse) => (this.#end = refuse));
    const id = ++this.#id;
    const answered = begun.then((worker) => new Promise((take, refuse) => {
      worker.onerror = (event) => refuse(new Error(event.message || "the worker came to grief"));
      worker.onmessage = ({ data }) => {
        if (data.id !== id) return;
        if ("progress" in data) hear(data.progress, data.share);
        else if ("error" in data) refuse(new Error(data.error));
        else take(data);
      };
      worker.postMessage({ id, args, files, wanted });
    }));
    try {
      return await Promise.race([answered, ended]);
    } catch (error) {
      // What trapped leaves a worker behind that is not asked again.
      if (this.#worker === begun) this.#worker = null;
      throw error;
    } finally {
      if (this.#id === id) this.#end = null;
    }
  }
}

const tool = new Tool();
// What the last run wrote, and how long it took, s: for whoever wants to look.
const last = { seconds: null, status: null, written: {}, said: "", trouble: null };

function text(bytes) {
  return new TextDecoder().decode(bytes);
}

function trouble(message) {
  last.trouble = message || null;
  $("#trouble").textContent = message;
  $("#trouble").hidden = !message;
}

function busy(what, share) {
  $("#state").hidden = what === null;
  $("#state span").textContent = what ?? "";
  const bar = $("#state progress");
  if (share === null || share === undefined) bar.removeAttribute("value");
  else bar.value = share;
}

// Runs the command line and says what goes wrong; undefined where something did.
async function command(args, files, wanted) {
  trouble("");
  busy("starting");
  const begun = performance.now();
  Object.assign(last, { seconds: null, status: null, written: {}, said: "" });
  try {
    const done = await tool.run(args, files, wanted, busy);
    Object.assign(last, done, { seconds: (performance.now() - begun) / 1000 });
    if (done.status === 0) return done;
    trouble(done.said.trim() || `the work failed with status ${done.status}`);
  } catch (error) {
    // Another run has taken its place and speaks for itself.
    if (tool.busy) return undefined;
    trouble(error.message);
  } finally {
    if (!tool.busy) busy(null);
  }
  return undefined;
}

function link(name, bytes, type) {
  const a = document.createElement("a");
  a.href = URL.createObjectURL(new Blob([bytes], { type }));
  a.download = name;
  a.textContent = name;
  return a;
}

const TYPES = { json: "application/json", html: "text/html", csv: "text/csv", toml: "text/plain" };

function show(done) {
  for (const old of $$("#links a")) URL.revokeObjectURL(old.href);
  const links = Object.entries(done.written).map(([name, bytes]) => link(name, bytes, TYPES[name.split(".").pop()]));
  $("#links").replaceChildren("Keep: ", ...links);
  $("#summary").textContent = done.said.trim();
  const frame = $("#result iframe");
  frame.hidden = !done.written["report.html"];
  if (!frame.hidden) frame.srcdoc = text(done.written["report.html"]);
  $("#result").hidden = false;
}

function chosen(input) {
  return [...input.files].map((blob) => ({ name: blob.name, blob }));
}

const OUTPUTS = ["--json", "result.json", "--report", "report.html"];

async function fit(form) {
  const files = chosen(form.record);
  if (files.length === 0) return trouble("no record was dropped");
  const args = ["modify", files[0].name, "--velocity", form.velocity.value, "--stroke", form.stroke.value];
  args.push("--method", form.method.value, "--out", "drive.csv", ...OUTPUTS);
  if (form.dt.value) args.push("--dt", form.dt.value);
  if (form.unit.value) args.push("--unit", form.unit.value);
  const done = await command(args, files, ["result.json", "report.html", "drive.csv"]);
  if (done) show(done);
}

async function diagnose(form) {
  const files = chosen(form.experiment);
  const tomls = files.filter(({ name }) => /\.toml$/i.test(name));
  if (tomls.length === 0) return trouble("no experiment was dropped: a TOML file, as `shakedown init` writes it, and the files it names");
  // An experiment has runs; a table or settings beside it have none.
  const heads = await Promise.all(tomls.map(({ blob }) => blob.slice(0, 1 << 20).text()));
  const experiment = tomls[Math.max(0, heads.findIndex((head) => /^\s*\[\[\s*runs\s*\]\]/m.test(head)))];
  const args = ["diagnose", experiment.name, "--model", "model.toml", ...OUTPUTS];
  const done = await command(args, files, ["result.json", "report.html", "model.toml"]);
  if (done) show(done);
}

// The paper's table with the limits that were turned.
function table(form) {
  return `[model]\nkind = "servo"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = ${form.velocity.value}\n\n` +
    `[table]\nstroke = ${form.stroke.value}\n`;
}

async function watch(form) {
  const files = [{ name: "limits.toml", blob: new Blob([table(form)]) }, ...chosen(form.record)];
  const args = ["run", "--table", "limits.toml", "--controller", form.controller.value];
  args.push("--modification", form.modification.value, "--trace", "trace.csv", "--json", "result.json");
  if (files[1]) args.push("--record", files[1].name);
  const done = await command(args, files, ["result.json", "trace.csv"]);
  if (done) draw(done, Number(form.velocity.value), Number(form.stroke.value));
}

function columns(csv) {
  const [head, ...rows] = csv.trim().split("\n");
  const names = head.split(",").map((name) => name.replace(/ \[.*/, ""));
  const values = rows.map((row) => row.split(",").map(Number));
  return Object.fromEntries(names.map((name, k) => [name, values.map((row) => row[k])]));
}

const SVG = "http://www.w3.org/2000/svg";

function element(name, attributes, content = "") {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = content;
  return made;
}

// A curve in at most a thousand steps, each the least and the greatest of what it stands for.
function path(values, x, y) {
  const step = Math.max(1, Math.floor(values.length / 1000));
  let d = "";
  for (let k = 0; k < values.length; k += step) {
    const part = values.slice(k, k + step);
    for (const v of new Set([Math.min(...part), Math.max(...part)])) d += `${d ? "L" : "M"}${x(k).toFixed(1)} ${y(v).toFixed(1)}`;
  }
  return d;
}

// One figure: curves over time, and the limit to either side.
function figure(title, time, curves, limit) {
  const [width, height, left, top] = [1000, 260, 60, 24];
  const most = 1.05 * Math.max(limit, ...curves.map(({ values }) => values.reduce((m, v) => Math.max(m, Math.abs(v)), 0)));
  const x = (k) => left + (k / (time.length - 1)) * (width - left - 8);
  const y = (v) => top + (1 - v / most) * (height / 2 - top);
  const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title });
  svg.append(element("text", { x: left, y: 14 }, title));
  for (const v of [-limit, 0, limit]) {
    svg.append(element("line", { x1: left, x2: width, y1: y(v), y2: y(v), stroke: v ? "#c33" : "currentColor", "stroke-dasharray": v ? "6 4" : "", opacity: 0.6 }));
    svg.append(element("text", { x: left - 6, y: y(v) + 4, "text-anchor": "end" }, v.toPrecision(3)));
  }
  curves.forEach(({ name, values, colour, width: stroke }, k) => {
    svg.append(element("path", { d: path(values, x, y), fill: "none", stroke: colour, "stroke-width": stroke }));
    svg.append(element("text", { x: width - 8, y: 14 + 15 * k, "text-anchor": "end", style: `fill: ${colour}` }, name));
  });
  svg.append(element("text", { x: width - 8, y: height - 2, "text-anchor": "end" }, `${time[time.length - 1].toFixed(1)} s`));
  return svg;
}

function draw(done, velocity, stroke) {
  const trace = columns(text(done.written["trace.csv"]));
  const metrics = JSON.parse(text(done.written["result.json"])).metrics;
  const said = document.createElement("p");
  said.textContent = `Acceleration error ${metrics.e_a.toPrecision(3)}, displacement error ${metrics.e_d.toPrecision(3)} ` +
    `(relative to the record), saturated for ${metrics.saturated_s.toFixed(2)} s`;
  $("#watch").replaceChildren(
    said,
    figure("displacement [m]", trace.time, [
      { name: "reference", values: trace.reference, colour: "#888", width: 3 },
      { name: "table", values: trace.displacement, colour: "#0a6ebd", width: 1.2 },
    ], stroke),
    figure("velocity [m/s]", trace.time, [{ name: "table", values: trace.velocity, colour: "#0a6ebd", width: 1.2 }], velocity),
  );
}

const WORK = { fit, diagnose, loop: watch };

function panel(name) {
  for (const form of $$(".panel")) form.hidden = form.id !== name;
  for (const button of $$("nav button")) button.setAttribute("aria-pressed", String(button.dataset.panel === name));
  $("#result").hidden = true;
  trouble("");
}

for (const button of $$("nav button")) button.addEventListener("click", () => panel(button.dataset.panel));
for (const form of $$(".panel")) {
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    WORK[form.id](form);
  });
  const drop = $(".drop", form);
  const input = $("input", drop);
  for (const kind of ["dragenter", "dragover", "dragleave", "drop"]) {
    drop.addEventListener(kind, (event) => {
      event.preventDefault();
      drop.classList.toggle("over", kind === "dragenter" || kind === "dragover");
      if (kind === "drop" && event.dataTransfer.files.length > 0) {
        input.files = event.dataTransfer.files;
        WORK[form.id](form);
      }
    });
  }
  input.addEventListener("change", () => WORK[form.id](form));
}
// A file dropped beside its place must not make the browser leave the page.
for (const kind of ["dragover", "drop"]) window.addEventListener(kind, (event) => event.preventDefault());

const loop = $("#loop");
loop.controller.replaceChildren(...CONTROLLERS.map((name) => new Option(name, name, name === "strong", name === "strong")));
let waiting = null;
for (const input of [loop.velocity, loop.stroke, loop.controller, loop.modification]) {
  const told = () => {
    const output = $("output", input.parentElement);
    if (output) output.textContent = input.value;
  };
  told();
  input.addEventListener("input", () => {
    told();
    clearTimeout(waiting);
    waiting = setTimeout(() => watch(loop), 150);
  });
}
$("#cancel").addEventListener("click", () => tool.cancel());
// A tab that is closed at work loses it: the browser asks first.
window.addEventListener("beforeunload", (event) => {
  if (tool.busy) event.preventDefault();
});
