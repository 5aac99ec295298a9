"""Which effects of the rough drives could be named at all, whatever the rules.

*Beside an unlisted cause.* For every such trial of `rough_drives.py`, and every listed effect there that matters, the
same drive without the unlisted cause is recorded, the effect is fitted to what the base model leaves, and of its
torque in the rows the share (squared) is taken that lies outside of what the channel of the unlisted cause can be: a
torque over position in one stretch for a bump or a zone, of the motor torque for a droop or a sensor that saturates,
of the acceleration for one that goes with it, of the time for a walk. An effect that lies within is the same torque,
whatever is its cause: to name it would be to name it where only the unlisted cause is there. Another joint that is
not recorded has no channel; there the share is 1.

*Single effects.* Of every one that matters the p-value is taken that it has in the rows if one knows which effect is
there, and tests no other. Without multiplicity, and without any other rule, that is the most that rows can say.

    python benchmarks/rough_limits.py runs/rough_2101.jsonl runs/rough_2301.jsonl
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from fricmodels.diagnosis import compare
from fricmodels.diagnosis.basis_functions import STRETCH, STRETCH_ALONG, basis_functions
from fricmodels.diagnosis.candidate_tests import CandidateTests, candidate_tests
from fricmodels.diagnosis.policy import POLICY
from fricmodels.diagnosis.verdict import outside
from fricmodels.errors import FricmodelsError
from rough.record import Case, record
from rough.trials import BASE, case_of, cleared

OVER_PLACE, OF_TORQUE = (STRETCH, STRETCH_ALONG), ("motor torque", "motor torque, along the motion")
CHANNELS = {
    "bump": OVER_PLACE,
    "zone": OVER_PLACE,
    "droop": OF_TORQUE,
    "saturating-sensor": OF_TORQUE,
    "absolute-acceleration": ("acceleration",),
    "random-walk": ("time, along the motion", "time, finely, along the motion", "time, the same in both directions"),
    "coupling": (),
}
"""What the torque of an unlisted cause may be, as sets of functions that the diagnosis has."""
EDGES, LEVELS = (0.0, 0.1, 0.3, 0.6), (0.001, 0.01, 0.1)
Row = dict[str, Any]


def rows(paths: list[str]) -> Iterator[Row]:
    """Yield one row for each listed effect that matters, alone or beside an unlisted cause, each trial once."""
    seen = set()
    for path in paths:
        for line in Path(path).read_text(encoding="utf-8").splitlines():
            trial = json.loads(line)
            if trial["kind"] not in ("beside", "single") or trial["status"] != "ok" or trial["key"] in seen:
                continue
            seen.add(trial["key"])
            named = {name for names in trial["last_names"] for name in names}
            for effect in trial.get("matter", []):
                row = {"key": trial["key"], "kind": trial["kind"], "effect": effect, "named": effect in named}
                if trial["kind"] == "beside":
                    yield {**row, "unlisted": trial["unlisted"][0], "outside": share_outside(trial, effect)}
                else:
                    clean = tested_alone(drive_of(trial), effect)
                    yield {**row, "p": clean.tested[0].p_value if clean and clean.tested else None}


def drive_of(trial: Row) -> Case:
    """Return the drive of a stored trial, drawn anew."""
    seed = int(trial["key"].rsplit(":", 1)[1])
    return case_of(trial["kind"], trial["name"], trial["index"], seed)[0]


def tested_alone(case: Case, effect: str) -> CandidateTests | None:
    """Return the test of one effect on what the base model leaves of a drive; ``None`` where that cannot be fitted."""
    try:
        base = compare(record(case), BASE, case.inertia)
        return candidate_tests(base.problem, base.estimate.parameters, only=[effect])
    except FricmodelsError:
        return None


def share_outside(trial: Row, effect: str) -> float | None:
    """Return the share of an effect's torque outside of what its trial's unlisted cause can be; ``None`` if not found.

    The least of the sets of functions counts.
    """
    unlisted = trial["unlisted"]
    tested = tested_alone(cleared(drive_of(trial), unlisted), effect)
    if tested is None or not tested.tested:
        return None
    found, problem = tested.tested[0], tested.problem
    torque = (found.evidence.coefficients @ found.found.columns)[None]
    sets = basis_functions(problem, tested.regression, POLICY)
    shares = [1.0]
    for channel in CHANNELS[unlisted[0]]:
        columns = sets[channel]() if channel in sets else np.zeros((0, problem.rows))
        columns = columns[tested.regression.visible(columns)] if len(columns) else columns
        shares += [outside(tested.regression, torque, columns)] if len(columns) else []
    return min(shares)


def beside(found: list[Row]) -> Iterator[str]:
    """Yield the lines about effects beside an unlisted cause."""
    yield "| outside of what the unlisted cause can be | effects that matter | named |"
    yield "|---|---|---|"
    known = [row for row in found if row["outside"] is not None]
    for low, high in zip(EDGES, (*EDGES[1:], np.inf), strict=True):
        here = [row for row in known if low <= row["outside"] < high]
        yield f"| {low:g} to {min(high, 1.0):g} | {len(here)} | {sum(row['named'] for row in here)} |"
    lost = [row for row in found if row["outside"] is None]
    yield f"| not found without the unlisted cause either | {len(lost)} | {sum(row['named'] for row in lost)} |"
    yield ""
    yield "| unlisted cause | effects that matter | named | not named, and the share outside |"
    yield "|---|---|---|---|"
    for cause in sorted({row["unlisted"] for row in found}):
        here = [row for row in found if row["unlisted"] == cause]
        missed = [
            f"`{row['effect']}` " + ("–" if row["outside"] is None else f"{row['outside']:.2f}")
            for row in here
            if not row["named"]
        ]
        yield f"| {cause} | {len(here)} | {len(here) - len(missed)} | {', '.join(missed)} |"


def single(found: list[Row]) -> Iterator[str]:
    """Yield the lines about single effects."""
    yield "| p-value, tested alone | single effects that matter | named | not named |"
    yield "|---|---|---|---|"
    for low, high in zip((0.0, *LEVELS), (*LEVELS, np.inf), strict=True):
        here = [row for row in found if row["p"] is not None and low <= row["p"] < high]
        missed = ", ".join(f"`{row['effect']}` {row['p']:.1g}" for row in here if not row["named"])
        yield f"| {low:g} to {min(high, 1.0):g} | {len(here)} | {sum(row['named'] for row in here)} | {missed} |"
    lost = [row for row in found if row["p"] is None]
    missed = ", ".join(f"`{row['effect']}`" for row in lost if not row["named"])
    yield f"| cannot be tested in the rows | {len(lost)} | {sum(row['named'] for row in lost)} | {missed} |"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="+", help="stored rows of rough_drives.py")
    found = []
    for row in rows(parser.parse_args().rows):
        found.append(row)
        print(len(found), *row.values(), file=sys.stderr, flush=True)
    print("\n".join(beside([row for row in found if row["kind"] == "beside"])))
    print()
    print("\n".join(single([row for row in found if row["kind"] == "single"])))


if __name__ == "__main__":
    main()
