"""What the log check says of short logs: pieces of 270 to 510 samples, as they are and with the torque's sign turned.

Of rough drives with one hidden effect and of the rig's, three pieces each, as they are and with position or velocity
alone; their samples are thinned until a piece spans a good part of the record. Printed is of how many what is said that
stops or warns, and of how many the turned sign is told. Run: ``python benchmarks/short_logs.py [--drives 6]``.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fricmodels.logcheck import Severity, findings
from fricmodels.recording import Recording
from hidden.draw import generator, mattering
from rough.record import record
from rough.trials import case_of

ROUGH = "gravity", "stribeck", "cogging", "load-friction"
RIG = "gravity", "stribeck", "cogging", "torque-offset", "backlash"
SHORTEST, LONGEST, PIECES = 270, 510, 3


def pieces(recording: Recording, index: int) -> Iterator[Recording]:
    """Yield three short pieces of a recording."""
    for piece in range(PIECES):
        samples = int(np.random.default_rng((index, piece)).integers(SHORTEST, LONGEST))
        step = max(1, len(recording) // (PIECES * samples))
        room = len(recording) - samples * step
        if room >= 0:
            begin = room * piece // PIECES
            cut = recording.select(slice(begin, begin + samples * step, step))
            yield cut
            for other in ("position", "velocity"):
                kept = {name: values for name, values in cut.channels.items() if name != other}
                if {"position", "velocity"} & kept.keys() and len(kept) < len(cut.channels):
                    yield replace(cut, channels=kept, derived=cut.derived & kept.keys())


def drawn(drives: int) -> Iterator[tuple[str, float | None, Recording]]:
    """Yield who simulated it, the inertia, and a piece."""
    for index in range(drives):
        for effect in ROUGH:
            case, *_ = case_of("single", effect, index, 9901)
            yield from (("rough", case.inertia, piece) for piece in pieces(record(case), index))
        for effect in RIG:
            case_of_rig = mattering(generator(9902, "single", effect, index), effect)
            if case_of_rig is not None:
                inertia = case_of_rig.comparison.drive.inertia
                yield from (("rig", inertia, piece) for piece in pieces(case_of_rig.recording, index))


def main() -> None:
    """Print the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=6)
    count: Counter[tuple[str, str]] = Counter()
    for who, inertia, piece in drawn(parser.parse_args().drives):
        count[who, "pieces"] += 1
        for found in findings(piece, inertia):
            if found.severity is not Severity.NOTE:
                count[who, f"{found.severity}: {found.kind}"] += 1
        turned = piece.with_channels(derived=False, torque=-piece.torque)
        count[who, "told"] += any(found.kind == "torque-sign" for found in findings(turned, inertia))
    for (who, what), times in sorted(count.items()):
        print(f"{who:6} {what:24} {times}")


if __name__ == "__main__":
    main()
