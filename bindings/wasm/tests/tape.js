// Plays a tape, in the format of shakedown_core::host, to the core: its answers as bytes.

import { ShakedownError } from "../shakedown.js";

const STATES = ["off", "ready", "running", "hold", "ramp-down", "tripped"];
const NUMBERS = [
  "reference", "displacement", "acceleration", "external", "velocity", "pressure_difference", "reference_velocity",
  "reference_acceleration", "second_displacement",
];

function code(act) {
  try {
    act();
    return 0;
  } catch (error) {
    if (error instanceof ShakedownError) return error.code;
    throw error;
  }
}

function step(controller, tape, at, answers, to) {
  const flags = tape.getUint32(at + 36, true);
  const sample = { limit_switch: (flags & 1) !== 0, relay_closed: (flags & 2) !== 0 };
  NUMBERS.forEach((name, place) => (sample[name] = tape.getFloat32(at + 4 * place, true)));
  const c = controller.step(sample);
  answers.setFloat32(to, c.valve, true);
  answers.setFloat32(to + 4, c.reference, true);
  answers.setFloat32(to + 8, c.velocity_limit, true);
  const flagged = [c.saturated, c.held, c.limited, c.relay_closed].reduce((bits, on, k) => bits | (on << k), 0);
  answers.setUint32(to + 12, flagged | (STATES.indexOf(c.state) << 4) | (c.trip << 8) | (c.missing << 16) | (c.changes << 24), true);
}

export function play(core, bytes) {
  const tape = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const answers = [];
  let controller = null;
  for (let at = 0; at < bytes.length; ) {
    const tag = tape.getUint32(at, true);
    const length = tape.getUint32(at + 4, true);
    const text = () => new TextDecoder().decode(bytes.subarray(at, at + length));
    const answer = new DataView(new ArrayBuffer(16));
    at += 8;
    if (tag === 1) answer.setUint32(0, code(() => (controller = core.controller(text()))), true);
    else if (tag === 2) answer.setUint32(0, code(() => controller.retune(text())), true);
    else if (tag === 3) answer.setUint32(0, code(() => controller.request(tape.getUint32(at, true))), true);
    else if (tag === 4) step(controller, tape, at, answer, 0);
    else throw new Error(`the tape is damaged at ${at}`);
    answers.push(new Uint8Array(answer.buffer));
    at += length;
  }
  return answers;
}
