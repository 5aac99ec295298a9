"""What each rule of the diagnosis is worth: every one is switched off in turn, on drives with a known hidden effect.

    python benchmarks/hidden_rules.py [--seeds N] [--effect NAME …] [--rule NAME …]

Each drive is diagnosed with the true effect on the list of candidates and off it; drives with nothing hidden besides.
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import fields

from fricmodels.diagnosis import Comparison, examine
from fricmodels.diagnosis.policy import POLICY, Policy
from fricmodels.rig import random_rig
from hidden.draw import EFFECTS, fitted, generator

Case = tuple[Comparison, str, bool]
"""A fitted model, what is hidden, and whether that is on the list."""


def drawn(effects: list[str], seeds: int) -> list[Case]:
    """Return the drives, fitted."""
    cases: list[Case] = []
    for effect in ["", *effects]:
        for seed in range(seeds):
            rig = random_rig(generator(seed, "rules", effect), [effect] if effect else [], samples=10_000)
            comparison = fitted(rig, rig.simulate())
            cases += [(comparison, effect, True), (comparison, effect, False)] if effect else [(comparison, "", True)]
    return cases


def answer(case: Case, policy: Policy) -> str:
    """Return in a word what is said: right, wrong (a name that is not the truth), unknown or adequate."""
    comparison, effect, listed = case
    diagnosis = examine(comparison, leave_out=() if listed else [effect], policy=policy)
    if not diagnosis.findings:
        return diagnosis.verdict.split("-")[0]
    return "right" if effect in diagnosis.findings[0].names else "wrong"


def kind(case: Case) -> str:
    return "nothing hidden" if not case[1] else "on the list" if case[2] else "off the list"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=1, help="drives of each effect")
    parser.add_argument("--effect", action="append", choices=EFFECTS, help="hidden effects; all by default")
    parser.add_argument("--rule", action="append", help="rules to switch off; all that can be by default")
    given = parser.parse_args()
    rules = [entry.name for entry in fields(Policy) if entry.metadata["off"] is not None]
    cases = drawn(given.effect or [*EFFECTS], given.seeds)
    before = [answer(case, POLICY) for case in cases]
    for name in ("nothing hidden", "on the list", "off the list"):
        counts = Counter(said for case, said in zip(cases, before, strict=True) if kind(case) == name)
        print(f"{name}: " + ", ".join(f"{count} {said}" for said, count in counts.most_common()))
    print("\n| without the rule | answers that change |\n|---|---|", flush=True)
    for rule in given.rule or rules:
        after = [answer(case, POLICY.without(rule)) for case in cases]
        changes = Counter(
            f"{kind(case)}: {one} → {other}"
            for case, one, other in zip(cases, before, after, strict=True)
            if one != other
        )
        print(f"| `{rule}` | {'; '.join(f'{text} ({count})' for text, count in changes.items())} |", flush=True)


if __name__ == "__main__":
    main()
