"""Plays a tape to the FMU through FMPy: tape.py FMU TAPE ANSWERS. The format is that of shakedown_core::host."""

import struct
import sys

from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

INPUTS = list(range(1, 10))
STEP = 0.001


class Player:
    def __init__(self, fmu: str) -> None:
        problems = validate_fmu(fmu)
        if problems:
            sys.exit("\n".join(str(problem) for problem in problems))
        description = read_model_description(fmu)
        self.fmu = FMU3Slave(
            instanceName="core",
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=extract(fmu),
        )
        self.fmu.instantiate(logMessage=lambda *_: None)
        self.begun = False
        self.ticks = 0
        self.asked = 0
        self.waiting: list[int] = []
        self.answers: list[bytes] = []

    def play(self, tag: int, content: bytes) -> None:
        if tag == 1:
            self.begin(content.decode())
        elif tag == 2:
            self.fmu.setString([13], [content.decode()])
            self.answer(self.fmu.getInt32([32])[0])
        elif tag == 3:
            # Acted on at the next step; 16 more asks for the same again.
            self.asked = ((self.asked >> 4) + 1) << 4 | (struct.unpack("<I", content)[0] + 1)
            self.fmu.setInt32([12], [self.asked])
            self.waiting.append(len(self.answers))
            self.answer(0)
        elif tag == 4:
            self.step(content)
        else:
            raise ValueError(f"the tape is damaged: no record has tag {tag}")

    def answer(self, *words: int) -> None:
        self.answers.append(struct.pack("<4I", *(words + (0,) * 4)[:4]))

    def begin(self, text: str) -> None:
        if self.begun:
            self.fmu.terminate()
            self.fmu.reset()
        self.asked = 0
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.setString([13], [text])
        self.answer(self.fmu.getInt32([32])[0])
        self.fmu.exitInitializationMode()
        self.begun, self.ticks = True, 0

    def step(self, content: bytes) -> None:
        numbers, flags = struct.unpack("<9f", content[:36]), struct.unpack("<I", content[36:])[0]
        self.fmu.setFloat32(INPUTS, numbers)
        self.fmu.setBoolean([10, 11], [bool(flags & 1), bool(flags & 2)])
        self.fmu.doStep(currentCommunicationPoint=self.ticks * STEP, communicationStepSize=STEP)
        self.ticks += 1
        if self.waiting:
            if len(self.waiting) > 1:
                raise ValueError("two requests ahead of one tick")
            code = self.fmu.getInt32([31])[0]
            self.answers[self.waiting.pop()] = struct.pack("<4I", code, 0, 0, 0)
        valve, reference, limit = self.fmu.getFloat32([20, 21, 22])
        state, trip, missing, changes = self.fmu.getInt32([23, 24, 29, 30])
        saturated, held, limited, relay = self.fmu.getBoolean([26, 27, 28, 25])
        status = saturated | held << 1 | limited << 2 | relay << 3 | state << 4 | trip << 8 | missing << 16 | changes << 24
        self.answers.append(struct.pack("<3fI", valve, reference, limit, status))


def main(fmu: str, tape: str, answers: str) -> None:
    player = Player(fmu)
    with open(tape, "rb") as file:
        while head := file.read(8):
            tag, length = struct.unpack("<II", head)
            player.play(tag, file.read(length))
    with open(answers, "wb") as file:
        file.write(b"".join(player.answers))


if __name__ == "__main__":
    main(*sys.argv[1:])
