// Runs the command line, compiled for WASI preview 1, in a worker: one run, one fresh instance, files that exist in memory only.
//
// In: { module } once, then { id, args, files: [{ name, blob }], wanted: [name] }. Out: { id, progress, share } while it works, then
// { id, status, said, written: { name: bytes } }, or { id, error } where the program itself came to grief.

// One run of the program: its status, what it said, and the files that are wanted of what it wrote.
async function run(module, { args, files, wanted }, hear) {
  const system = new System(["shakedown", ...args], files, hear);
  let instance;
  let status = 0;
  try {
    instance = await WebAssembly.instantiate(module, system.imports(module, () => instance.exports.memory));
    instance.exports._start();
  } catch (error) {
    if (!(error instanceof Exit)) throw new Error([system.said + system.line, String(error)].join("\n").trim());
    status = error.status;
  }
  const written = {};
  for (const name of wanted) {
    const file = system.files.get(name);
    if (file instanceof Written) written[name] = file.content();
  }
  return { status, said: system.said + system.line, written };
}

let program = null;

self.onmessage = async ({ data }) => {
  if (data.module) {
    program = data.module;
    return;
  }
  const { id } = data;
  try {
    const hear = (progress, share) => self.postMessage({ id, progress, share });
    self.postMessage({ id, ...(await run(program, data, hear)) });
  } catch (error) {
    self.postMessage({ id, error: error.message });
  }
};
