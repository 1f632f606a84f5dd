// The control core in a page or in Node: WebAssembly built from bindings/c, no imports, nothing but this file around it.
//
//   const core = await Core.from(bytes);             // of shakedown_c.wasm
//   const controller = core.controller(settings);    // a settings file's words: "rate = 1000\n[guard]\n"
//   controller.request("arm");
//   const command = controller.step({ reference: 0.01, displacement: 0, acceleration: 0 });
//
// SI units throughout. Numbers are rounded once, to f32, where they enter.

const ABI = 1;
const PAGE = 65536;
const REQUESTS = ["arm", "start", "hold", "resume", "stop", "off", "reset", "trip"];
const STATES = ["off", "ready", "running", "hold", "ramp-down", "tripped"];
const NUMBERS = [
  "reference", "displacement", "acceleration", "external", "velocity", "pressure_difference", "reference_velocity",
  "reference_acceleration", "second_displacement",
];

/** What the core refuses, with its code and message. */
export class ShakedownError extends Error {
  constructor(core, code) {
    super(core.meaning(code));
    this.name = "ShakedownError";
    this.code = code;
  }
}

/** The library. */
export class Core {
  static async from(bytes) {
    const { instance } = await WebAssembly.instantiate(bytes, {});
    return new Core(instance.exports);
  }

  constructor(exports) {
    this.exports = exports;
    if (exports.shakedown_abi() !== ABI) throw new Error(`the library is of version ${exports.shakedown_abi()}, not ${ABI}`);
  }

  /** What a code means. */
  meaning(code) {
    const bytes = new Uint8Array(this.exports.memory.buffer, this.exports.shakedown_error(code));
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  /** A controller of these settings; with a guard it is off until it is armed and started. */
  controller(settings = "") {
    return new Controller(this, settings);
  }
}

/** A controller: one sample in, one command out. */
export class Controller {
  #core;
  #call;
  #at;

  constructor(core, settings) {
    this.#core = core;
    this.#call = core.exports;
    // Pages of its own: the library allocates nothing and gives none back.
    const sizes = [0, 1, 2, 3].map((what) => (this.#call.shakedown_sizeof(what) + 15) & ~15);
    const [storage, tuning, sample, command] = sizes;
    const base = this.#call.memory.grow(1) * PAGE;
    if (storage + tuning + sample + command > PAGE / 2) throw new Error("a controller does not fit into a page");
    this.#at = { storage: base, settings: base + storage, sample: base + storage + tuning };
    this.#at.command = this.#at.sample + sample;
    this.#at.text = base + PAGE / 2;
    this.#settle(settings, (at) => this.#call.shakedown_init(at.storage, storage, at.settings));
  }

  #check(code) {
    if (code !== 0) throw new ShakedownError(this.#core, code);
  }

  #settle(settings, take) {
    const bytes = new TextEncoder().encode(settings);
    if (bytes.length > PAGE / 2) throw new RangeError("the settings are too long");
    const at = this.#at;
    new Uint8Array(this.#call.memory.buffer, at.text).set(bytes);
    this.#check(this.#call.shakedown_settings_default(at.settings));
    this.#check(this.#call.shakedown_settings_read(at.settings, at.text, bytes.length));
    this.#check(take(at));
  }

  /** Exchanges the settings between two ticks, whole or not at all. */
  retune(settings) {
    this.#settle(settings, (at) => this.#call.shakedown_retune(at.storage, at.settings));
  }

  /** Asks for a change of state, by name or number. */
  request(request) {
    const number = typeof request === "number" ? request : REQUESTS.indexOf(request);
    if (!Number.isInteger(number) || number < 0 || number > 255) throw new RangeError(`there is no request ${request}`);
    this.#check(this.#call.shakedown_request(this.#at.storage, number));
  }

  /** One tick. What a sample leaves out is zero. */
  step(sample) {
    const at = this.#at;
    const input = new DataView(this.#call.memory.buffer, at.sample);
    NUMBERS.forEach((name, place) => input.setFloat32(4 * place, sample[name] ?? 0, true));
    input.setUint8(36, sample.limit_switch ? 1 : 0);
    input.setUint8(37, sample.relay_closed ? 1 : 0);
    this.#check(this.#call.shakedown_step(at.storage, at.sample, at.command));
    const output = new DataView(this.#call.memory.buffer, at.command);
    const [state, trip, relay, saturated, held, limited, missing, changes] =
      new Uint8Array(this.#call.memory.buffer, at.command + 12, 8);
    return {
      valve: output.getFloat32(0, true),
      reference: output.getFloat32(4, true),
      velocity_limit: output.getFloat32(8, true),
      state: STATES[state],
      trip,
      relay_closed: relay !== 0,
      saturated: saturated !== 0,
      held: held !== 0,
      limited: limited !== 0,
      missing,
      changes,
    };
  }
}
