"""The recordings of the ablation: a base law fitted to each, and what is known of the truth."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricmodels.diagnosis import Comparison, compare
from fricmodels.readers import read
from fricmodels.recording import Recording
from fricmodels.rig import random_rig
from fricmodels.tournament.config import Config, load_config
from fricmodels.tournament.sources import Sources, recordings_of, sources
from hidden.draw import EFFECTS, fitted, generator
from rough import trials
from rough.effects import LISTED, UNLISTED
from rough.judge import is_right
from rough.record import record

Row = dict[str, Any]
Given = tuple[Recording, str, float | None]
ROOT = Path(__file__).resolve().parent.parent.parent
DATA, PREPARED = ROOT.parent / "shared" / "data", ROOT / "build" / "measured"
ANY = "any"
"""The truth of a real recording: nobody knows it, and only what changes is told."""


@dataclass(frozen=True)
class Case:
    """A fitted model and what is hidden.

    Attributes:
        given: the recording, the law, and the inertia where it is known.
        comparison: the law, fitted.
        truth: row of what is there, as :mod:`rough.judge` reads it; of a rig without look-alikes.
        matter: effects that are there and lower the test error by a tenth.
        leave_out: effects that are off the list.
    """

    given: Given
    comparison: Comparison
    truth: Row
    matter: tuple[str, ...]
    leave_out: tuple[str, ...] = ()

    def is_right(self, names: list[str]) -> bool:
        """Whether a class of look-alikes holds something that is there."""
        return self.truth == {"real": ANY} or is_right(self.truth, names)


def keys(counts: dict[str, int], *, with_real: bool = True, logs: Sequence[str] = ()) -> Iterator[str]:
    """Yield the key of every case, ``set:kind:name:index``, in an order in which an early end leaves some of each."""
    each = {
        "rig:null": [""],
        "rig:listed": EFFECTS,
        "rig:unlisted": EFFECTS,
        "rig:pair": [""],
        "rough:null": [""],
        "rough:single": tuple(LISTED),
        "rough:several": [""],
        "rough:beside": tuple(UNLISTED),
        "rough:unlisted": tuple(UNLISTED),
    }
    for index in range(max(1, *counts.values())):
        for kind, names in each.items():
            if index < counts[kind]:
                yield from (f"{kind}:{name}:{index}" for name in names)
        if index == 0 and with_real and DATA.is_dir():
            yield from (f"real::{name}:0" for name in REAL)
        if index == 0:
            yield from (f"log::{name}:0" for name in logs)


def case(key: str, seed: int, logs: Path | None = None) -> Case:
    """Return a case; the same for the same key and seed.

    Args:
        key: of the case.
        seed: from which it is drawn.
        logs: tournament whose datasets are the logs.
    """
    place, kind, name, index = key.split(":")
    if logs is not None and place == "log":
        given = log(logs, name)
        return Case(given, compare(*given), {"real": ANY}, ())
    if place == "real":
        given = real(name)
        return Case(given, compare(*given), {"real": ANY}, ())
    if place == "rig":
        return _of_rig(kind, name, int(index), seed)
    rng = np.random.default_rng([seed, zlib.crc32(f"{kind}:{name}".encode()), int(index)])
    listed, unlisted = trials.hidden(rng, kind, name)
    drawn = trials.drawn(rng, listed, unlisted, delayed=kind in ("several", "beside"))
    given = record(drawn), trials.BASE, drawn.inertia
    first = compare(*given)
    row: Row = {
        **trials.described(drawn),
        "listed": sorted(listed),
        "rests": float(np.mean(first.problem.resting)),
        "turned": float(np.ptp(given[0]["position"])) if "position" in given[0] else None,
    }
    matter = trials.truth(first, frozenset(listed), drawn)["matter"] if listed else []
    return Case(given, first, row, tuple(matter))


def _of_rig(kind: str, name: str, index: int, seed: int) -> Case:
    rng = generator(seed, "rules", kind if kind in ("null", "pair") else name, index)
    names = [str(n) for n in rng.choice(EFFECTS, 2, replace=False)] if kind == "pair" else [name] * bool(name)
    rig = random_rig(rng, names, samples=10_000)
    row = {"listed": names, "lag_samples": 0.0, "hidden": [], "rests": 1.0, "load": "time", "motion": "", "turned": 9.0}
    off = kind == "unlisted"
    recording = rig.simulate()
    given = recording, rig.friction.law, rig.inertia
    return Case(given, fitted(rig, recording), row | {"listed": [] if off else names}, (), tuple(names) if off else ())


REAL = (
    "emps",
    "laas speed loop",
    "laas acceleration",
    *(f"tiago arm {i}" for i in (1, 2, 3, 4)),
    *(f"tx40 joint {i}" for i in (1, 2, 3, 5, 6)),
    "xl330",
    "kuka joint 1",
    "kuka joint 6",
)


def listed(logs: Path) -> tuple[Config, Sources]:
    """Return a tournament and its recordings."""
    config = load_config(logs)
    return config, sources(config, logs.parent)[0]


def log(logs: Path, name: str) -> Given:
    """Return a dataset of a tournament, its law, and the inertia where it is known."""
    config, every = listed(logs)
    source = next(source for source in every if source.dataset == name)
    return recordings_of(source)[0], config.models[0], source.inertia


def real(name: str) -> Given:
    """Return a real recording, a law, and the inertia where it is known."""
    from measured import emps, kuka, other_joints, tx40, xl330

    source, *rest = name.split()
    law = "coulomb-viscous"
    match source:
        case "emps":
            return emps.recording(DATA), "asymmetric-coulomb-viscous", None
        case "laas":
            file = "speed_loop_500Hz.csv" if rest[0] == "speed" else "acceleration_1kHz.csv"
            columns = ["time=Time:s", "torque=Iq:0.0318 N*m", "velocity=Velocity:rad/s", "position=Position:rad"]
            return read(DATA / "laas_motor" / file, columns=columns), law, None
        case "tiago":
            return other_joints.arm(DATA, int(rest[1]), False), law, None
        case "tx40":
            return read(PREPARED / f"tx40_joint{rest[1]}.csv"), law, tx40.INERTIA
        case "xl330":
            return xl330.recording(PREPARED, "M1", "fit"), law, None
        case _:
            return kuka.recording(DATA, int(rest[1]), "A"), law, None
