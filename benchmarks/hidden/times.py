"""Time and memory of a diagnosis over all effects, in a fresh process on one thread."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

CHANNELS = ("time", "torque", "velocity", "position", "load_torque", "temperature")


def measure() -> dict[str, float]:
    """Return seconds (cold, warm) for 20 000 samples, and seconds and peak memory for two million."""
    with tempfile.TemporaryDirectory() as folder:
        for samples in (20_000, 2_000_000):
            subprocess.run([sys.executable, __file__, "simulate", folder, str(samples)], check=True)
        found = subprocess.run(
            [sys.executable, __file__, "diagnose", folder], check=True, capture_output=True, text=True
        )
    return dict(json.loads(found.stdout.splitlines()[-1]))


def simulate(folder: Path, samples: int) -> None:
    from fricmodels.rig import random_rig

    rig = random_rig(np.random.default_rng(3), ["load-friction"], scale="robot-joint", excitation="tracking")
    rig = rig.model_copy(update={"samples": samples})
    recording = rig.simulate()
    channels = {name: recording[name] for name in CHANNELS if name in recording}
    channels["temperature"] = 20 + np.linspace(0, 10, len(recording))
    np.savez(folder / f"{samples}.npz", inertia=rig.inertia, **channels)


def diagnosed(folder: Path, samples: int) -> float:
    """Return the processor time of one diagnosis [s]; unlike the clock's, it does not depend on who else computes."""
    from fricmodels.diagnosis import diagnose
    from fricmodels.dimension import Motion
    from fricmodels.model import Model
    from fricmodels.recording import Recording

    with np.load(folder / f"{samples}.npz") as data:
        channels = {name: data[name] for name in data.files if name != "inertia"}
        inertia = float(data["inertia"])
    recording = Recording("times", Motion.ROTARY, channels, np.zeros(len(channels["time"]), dtype=np.int64))
    began = time.process_time()
    diagnose(recording, Model.parse("coulomb-viscous"), inertia)
    return time.process_time() - began


def peak() -> float:
    """Return the largest resident memory of this process so far [GB]."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


if __name__ == "__main__":
    place = Path(sys.argv[2])
    if sys.argv[1] == "simulate":
        simulate(place, int(sys.argv[3]))
    else:
        cold = diagnosed(place, 20_000)
        warm = min(diagnosed(place, 20_000) for _ in range(3))
        long = diagnosed(place, 2_000_000)
        print(json.dumps({"cold": cold, "warm": warm, "long": long, "peak_gb": peak()}))
