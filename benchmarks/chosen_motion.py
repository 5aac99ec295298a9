"""Is the right structure chosen by simulated motion? On simulated rigs with hidden effects, judged on another motion.

``python benchmarks/chosen_motion.py --seed 2032`` draws one rig an effect, climbs its ladder from the law that it
states, adds rungs that are not in it, and asks :func:`fricmodels.motion.judged`. Beside it the rule by three blocks
(the least squared error of what was kept back, within one standard error over the blocks). Each is refitted to all of
the recording, and simulates the same rig along another motion. Rows go to a JSONL file as they come.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
DECOYS = ("stribeck", "position-friction")
"""Effects that are added to the last rung, one after the other, where they are not in it: what must not be taken."""
_OTHER = {"velocity": 0.8, "frequency": 1.3, "amplitude": 0.9}
"""The other motion, of what was recorded; its phases are others too."""


def other_motion(rig: Any) -> Any:
    """Return the same drive under another motion."""
    told = rig.excitation
    changed = {k: getattr(told, k) * f for k, f in _OTHER.items() if isinstance(getattr(told, k, None), float)}
    return rig.model_copy(update={"seed": rig.seed + 1000, "excitation": told.model_copy(update=changed)})


def by_blocks(found: list[Any]) -> int:
    """Return the place of what the rule by blocks takes."""
    squares = {}
    for i, each in enumerate(found):
        if each.fit is not None:
            position, velocity = each.kept(each.fit.parameters)
            run, measured = each.kept.recording.run, each.kept.recording
            known = "position" in measured
            error = position - measured["position"] if known else velocity - measured.velocity
            squares[i] = np.array([np.mean(error[each.kept.scored & (run == n)] ** 2) for n in np.unique(run)])
    best = min(squares, key=lambda i: float(np.mean(squares[i])))
    within = [
        i
        for i, own in squares.items()
        if np.mean(own - squares[best]) <= np.std(own - squares[best], ddof=1) / math.sqrt(len(own))
    ]
    return min(within or [best], key=lambda i: (len(found[i].rung.drive.parameters), i))


def trial(effect: str, seed: int) -> dict[str, Any]:
    """Draw a rig and let both rules choose."""
    from fricmodels import improve
    from fricmodels.diagnosis import kept_back, ready
    from fricmodels.drive import Drive
    from fricmodels.model import Model
    from fricmodels.motion import Rung, Simulator, fit_motion, judged, motion_errors
    from hidden.draw import generator, mattering

    begin = time.process_time()
    drawn = mattering(generator(seed, "motion", effect), effect)
    if drawn is None:
        return {"status": "undrawn"}
    rig, whole = drawn.rig, ready(drawn.recording)
    other = ready(other_motion(rig).simulate())
    ladder = improve(drawn.recording, rig.friction.law, rig.inertia)
    steps = list({rung.model: rung.comparison for rung in ladder.rungs}.values())
    rungs = [Rung(step.drive, step.estimate.parameters) for step in steps]
    for decoy in DECOYS:
        name = rungs[-1].name
        if decoy not in name:
            drive = Drive(Model.parse(f"{name}+{decoy}").on(whole), rig.inertia, whole.motion)
            rungs.append(Rung(drive, {**_neutral(drive, whole), **rungs[-1].parameters}))
    found = judged(rungs, *kept_back(whole))
    errors = []
    for each in found:
        if each.fit is None:
            errors.append(math.inf)
            continue
        fit = fit_motion(Simulator(each.rung.drive, whole), [each.fit.parameters, each.rung.parameters])
        own = motion_errors(Simulator(each.rung.drive, other), fit.parameters)
        errors.append(own.position if math.isfinite(own.position) else own.velocity)
    new = next(i for i, each in enumerate(found) if each.chosen)
    old = by_blocks(found)
    return {
        "status": "ok",
        "rungs": [each.rung.name for each in found],
        "errors": errors,
        "ladder": len(steps),
        "parts": new,
        "blocks": old,
        "seconds": time.process_time() - begin,
    }


def _neutral(drive: Any, recording: Any) -> dict[str, float]:
    """Return parameters that a fit of the torque gives, where it can be done."""
    from fricmodels.errors import FricmodelsError
    from fricmodels.weakform.estimate import estimate

    try:
        return dict(estimate(drive, recording)[1].parameters)
    except FricmodelsError:
        return {}


def lines(rows: list[dict[str, Any]]) -> list[str]:
    """Return the table."""
    text = ["| rig | ladder | taken by parts | by blocks | error, by parts over by blocks | over the best |"]
    text.append("|---|---|---|---|---|---|")
    ratios, over, wide = [], [], []
    for row in rows:
        if row["status"] != "ok":
            continue
        errors, names = row["errors"], row["rungs"]
        new, old = errors[row["parts"]], errors[row["blocks"]]
        ratios.append(new / old)
        over.append(new / min(errors))
        wide.append(old / min(errors))
        short = [names[row[rule]].partition("+")[2] or "the law alone" for rule in ("parts", "blocks")]
        text.append(
            f"| {row['effect']} | {row['ladder']} | {short[0]} | {short[1]} | {ratios[-1]:.2f} | {over[-1]:.2f} |"
        )
    if ratios:
        mean = [float(np.exp(np.mean(np.log(values)))) for values in (ratios, over, wide)]
        better, worse = sum(r < 0.99 for r in ratios), sum(r > 1.01 for r in ratios)
        text += [
            "",
            f"{len(ratios)} rigs: geometric mean of the error by parts over that by blocks {mean[0]:.3f}; "
            f"smaller on {better}, larger on {worse}. "
            f"Over the best rung with hindsight: {mean[1]:.2f} by parts, {mean[2]:.2f} by blocks.",
        ]
    return text


def main() -> None:
    from compensation import EFFECTS

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=2032)
    parser.add_argument("--only", action="append", choices=EFFECTS, help="this effect (repeatable)")
    parser.add_argument("--out", default=str(ROOT / "runs" / "chosen_motion.jsonl"))
    given = parser.parse_args()
    path = Path(given.out)
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    rows = [row for row in rows if row["seed"] == given.seed]
    done = {row["effect"] for row in rows}
    for effect in given.only or EFFECTS:
        if effect in done:
            continue
        try:
            row = trial(effect, given.seed)
        except Exception as error:
            row = {"status": "failed", "message": f"{type(error).__name__}: {error}".splitlines()[0]}
        rows.append({"effect": effect, "seed": given.seed, **row})
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(rows[-1]) + "\n")
        print(rows[-1], flush=True)
    print("\n".join(lines(rows)))


if __name__ == "__main__":
    main()
