"""Steps per second of the Gymnasium environments against the number of processes.

    .venv/bin/python tests/bench/gym.py [PROCESSES...]      with SUTURA_LIBRARY and PYTHONPATH set
"""

import os
import sys
import time
from pathlib import Path

import gymnasium
import numpy as np
import sutura.gym  # noqa: F401

HANDS = {"DriveNeedle": [0.5, 0, 0], "PullTaut": [0, 0, 0.2]}
SECONDS = 20.0


def processor_time(processes: list[int]) -> float:
    """s, that these processes have taken so far."""
    ticks = 0
    for process in processes:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def measure(task: str, processes: int) -> tuple[float, float]:
    """Steps per second of wall time, all environments together, and of processor time."""
    envs = gymnasium.make_vec(f"sutura/{task}-v0", num_envs=processes, vectorization_mode="async")
    envs.reset(seed=1)  # makes what an environment makes once
    workers = [os.getpid(), *(p.pid for p in envs.processes)]
    before = processor_time(workers)
    actions = np.array([HANDS[task]] * processes, dtype=float)
    steps, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < SECONDS:
        envs.step(actions)
        steps += processes
    wall, taken = time.perf_counter() - begin, processor_time(workers) - before
    envs.close()
    return steps / wall, steps / taken


if __name__ == "__main__":
    counts = [int(a) for a in sys.argv[1:]]
    while not sys.argv[1:] and (not counts or 2 * counts[-1] <= (os.cpu_count() or 1)):
        counts.append(2 * counts[-1] if counts else 1)
    print(f"{'task':12} processes  steps/s  steps/s of processor time")
    for task in HANDS:
        for count in counts:
            wall, processor = measure(task, count)
            print(f"{task:12} {count:9} {wall:8.0f} {processor:8.0f}", flush=True)
