"""Plays a tape through the package: tape.py TAPE ANSWERS. The format is that of shakedown_core::host.

Every second stretch of samples goes through `step`, one by one, the others through `steps` at once.
"""

import struct
import sys

import numpy as np

from shakedown_table import SAMPLE, Controller, Sample, Settings, ShakedownError

REQUESTS = ["arm", "start", "hold", "resume", "stop", "off", "reset", "trip"]
STATES = ["off", "ready", "running", "hold", "ramp-down", "tripped"]
NUMBERS = [name for name in SAMPLE.names if name != "flags"]


class Player:
    def __init__(self) -> None:
        self.controller = Controller()
        self.sample = Sample()
        self.stretch: list[bytes] = []
        self.one_by_one = False
        self.answers: list[bytes] = []

    def play(self, tag: int, content: bytes) -> None:
        if tag == 4:
            self.stretch.append(content)
            return
        self.flush()
        if tag == 1:
            self.answer(lambda: self.begin(content.decode()))
        elif tag == 2:
            self.answer(lambda: self.controller.retune(Settings(content.decode())))
        elif tag == 3:
            self.answer(lambda: self.controller.request(REQUESTS[struct.unpack("<I", content)[0]]))
        else:
            raise ValueError(f"the tape is damaged: no record has tag {tag}")

    def begin(self, text: str) -> None:
        self.controller = Controller(Settings(text))

    def answer(self, act) -> None:
        try:
            act()
            code = 0
        except ShakedownError as error:
            code = error.code
        self.answers.append(struct.pack("<4I", code, 0, 0, 0))

    def flush(self) -> None:
        samples = np.frombuffer(b"".join(self.stretch), SAMPLE)
        if self.one_by_one:
            self.answers.extend(self.step(sample) for sample in samples)
        else:
            self.answers.append(self.controller.steps(samples).tobytes())
        self.one_by_one = not self.one_by_one
        self.stretch.clear()

    def step(self, given: np.void) -> bytes:
        for name in NUMBERS:
            setattr(self.sample, name, given[name])
        self.sample.limit_switch = bool(given["flags"] & 1)
        self.sample.relay_closed = bool(given["flags"] & 2)
        c = self.controller.step(self.sample)
        status = c.saturated | c.held << 1 | c.limited << 2 | c.relay_closed << 3
        status |= STATES.index(c.state) << 4 | c.trip << 8 | c.missing << 16 | c.changes << 24
        return struct.pack("<3fI", c.valve, c.reference, c.velocity_limit, status)


def main(tape: str, answers: str) -> None:
    player = Player()
    with open(tape, "rb") as file:
        while head := file.read(8):
            tag, length = struct.unpack("<II", head)
            player.play(tag, file.read(length))
    player.flush()
    with open(answers, "wb") as file:
        file.write(b"".join(player.answers))


if __name__ == "__main__":
    main(*sys.argv[1:])
