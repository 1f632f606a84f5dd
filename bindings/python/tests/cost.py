"""What calls cost, in time of the processor, ns: cost.py. Prints the medians of `step` a call and of `steps` a sample."""

import statistics
import time

import numpy as np

import shakedown_table as st

CALLS, BLOCK = 1_000_000, 1000


def main() -> None:
    controller, sample = st.Controller(), st.Sample(0.01)
    step, times = controller.step, []
    for _ in range(CALLS // BLOCK):
        begin = time.thread_time_ns()
        for _ in range(BLOCK):
            step(sample)
        times.append((time.thread_time_ns() - begin) / BLOCK)
    samples, whole = np.zeros(60_000, st.SAMPLE), []
    samples["reference"] = 0.01
    controller = st.Controller()
    for _ in range(50):
        begin = time.thread_time_ns()
        controller.steps(samples)
        whole.append((time.thread_time_ns() - begin) / len(samples))
    print(f"{statistics.median(times):.1f} {statistics.median(whole):.1f}")


if __name__ == "__main__":
    main()
