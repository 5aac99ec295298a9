"""How much of a torque that a model lacks enters the printed torque error, and what each window shows.

    python benchmarks/torque_error.py            # ripple of ten frequencies on a simulated drive
    python benchmarks/torque_error.py --measured # recordings in ../shared/data: every window beside the older figure

The ripple is hidden in two ways: as a load on the drive that is not recorded (the rig's ``load`` without its channel)
and as torque that the torque sensor shows and that does not reach the drive. Its share is by how much it raises the
squared error of the fitted model, over its own mean square; a drive at rest shows no load, so the motion is a fast one.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from fricmodels.diagnosis import compare
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.rig import Rig
from fricmodels.score import sliding_half_width

RATE = 1000.0
FREQUENCIES = np.geomspace(1.0, RATE / 4, 10)
SENSORS = {
    "velocity": {"velocity": "measured", "position": False, "velocity_noise_percent": 0.01},
    "positions": {"velocity": "none", "encoder_step": 1e-7},
}
FINER = 8
"""The rig runs at so many times the rate of the recording: its load is a straight line between its samples."""
RIPPLE = 3.0
"""Amplitude [N m]; the RMS motor torque is 71 N m, the Coulomb torque 10 N m."""
DATA = Path(__file__).parents[2] / "shared" / "data"


def recording(sensors: str, way: str = "", frequency: float = 0.0, samples: int = 12_000) -> Recording:
    """Return a recording of the rig with a torque ripple that no channel tells of.

    Args:
        sensors: one of :data:`SENSORS`.
        way: ``motion``, a load that moves the drive; ``torque``, in the recorded torque alone; else no ripple.
        frequency: of the ripple [Hz].
        samples: length of the recording.
    """
    rig = Rig(
        name=f"{way} {frequency:.4g} Hz",
        inertia=1.5,
        friction={"viscous": 4.0, "coulomb": 10.0},
        excitation={"kind": "multisine", "amplitude": 100.0, "frequency": 0.5},
        load={"amplitude": RIPPLE, "frequency": frequency} if way == "motion" else None,
        sensors=SENSORS[sensors],
        rate=FINER * RATE,
        samples=FINER * samples,
        substeps=4,
        hold=False,
    )
    simulated = rig.simulate().select(slice(None, None, FINER))
    channels = {name: values for name, values in simulated.channels.items() if name != "load_torque"}
    if way == "torque":
        channels["torque"] = channels["torque"] + RIPPLE * np.sin(2 * np.pi * frequency * channels["time"] + 0.3)
    return Recording(simulated.name, simulated.motion, channels, simulated.run)


def errors(recorded: Recording) -> list[float]:
    """Return the error of each band [N m], on what was fitted and on what was kept back together."""
    comparison = compare(recorded, "coulomb-viscous", 1.5)
    train, test = len(comparison.train), len(comparison.test)
    return [
        float(np.sqrt((train * band.SI**2 + test * band.held_out_SI**2) / (train + test)))
        for band in comparison.errors.bands
    ]


def shares(sensors: str, way: str, frequency: float, without: Sequence[float], samples: int = 12_000) -> list[float]:
    """Return by how much a ripple raises the error of each band, in squares, as a share of its RMS."""
    found = errors(recording(sensors, way, frequency, samples))
    raised = [max(one**2 - other**2, 0.0) for one, other in zip(found, without, strict=True)]
    return [float(np.sqrt(2 * each)) / RIPPLE for each in raised]


def ripples() -> bool:
    """Print the share of the ripple in every band; return whether 90 % of it enters the error per sample."""
    least = np.inf
    for sensors in SENSORS:
        without = errors(recording(sensors))
        print(f"\n{sensors} measured; error without ripple [N m]: {', '.join(f'{e:.3g}' for e in without)}")
        for way in ("motion", "torque"):
            print(f"ripple in the {way}: share of its RMS in the error per sample, over 5, 20 and 100 ms [%]")
            for frequency in FREQUENCIES:
                found = shares(sensors, way, float(frequency), without)
                least = min(least, found[0])
                print(f"{frequency:8.2f} Hz", *(f"{100 * share:7.1f}" for share in found), flush=True)
    print(f"\nleast share in the error per sample: {100 * least:.1f} % (asked: 90 %)")
    return least >= 0.9


def recordings(folder: Path) -> Iterator[tuple[Recording, str, float | None]]:
    """Yield the measured recordings that are there, each with a model and the inertia where that is known.

    Args:
        folder: where files are written that have to be prepared.
    """
    from measured import emps, tx40

    if (DATA / "emps").is_dir():
        for model in ("coulomb-viscous", "asymmetric-coulomb-viscous"):
            yield emps.recording(DATA), model, None
    if (DATA / "tx40").is_dir():
        for path in tx40.prepare(DATA, folder)[:3]:
            yield read(path), "coulomb-viscous", tx40.INERTIA


def measured() -> None:
    """Print every band of the measured recordings, and the figure of the older window that the data chose."""
    print("Test error, in brackets what sensor noise alone would leave, in % of the RMS motor torque\n")
    print("| recording | model | interval ms | per sample | 5 ms | 20 ms | 100 ms | older figure | its window ms |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for recorded, model, inertia in recordings(Path(folder)):
            comparison = compare(recorded, model, inertia)
            interval = 1000 * comparison.train.interval
            bands = {band.window_ms: band for band in comparison.errors.bands}
            shown = [comparison.errors.per_sample, *(bands.get(window) for window in (5.0, 20.0, 100.0))]
            cells = ["–" if b is None else f"{b.held_out_percent:.3g} ({b.noise_floor_percent:.2g})" for b in shown]
            older = f"{comparison.sliding.held_out_percent:.3g} ({comparison.sliding.noise_percent:.2g})"
            width = 2 * sliding_half_width(comparison.train) * interval
            print(
                "|",
                " | ".join([recorded.name, model, f"{interval:.3g}", *cells, older, f"{width:.3g}"]),
                "|",
                flush=True,
            )


def main() -> int:
    """Run what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measured", action="store_true", help="recordings in ../shared/data")
    if parser.parse_args().measured:
        measured()
        return 0
    return 0 if ripples() else 1


if __name__ == "__main__":
    sys.exit(main())
