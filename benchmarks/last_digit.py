"""Fits of `batch` whose printed digits or words hang on the order in which a sum is taken.

Every cell of the coverage matrix twice, each with its own law and with larger ones that it hardly determines, fitted
automatically and to one set of rows, in two processes with other kernels of linear algebra.

    python benchmarks/last_digit.py                          Haswell's kernels against those that this processor takes
    python benchmarks/last_digit.py --kernels Sandybridge

About a minute of CPU time.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from typing import Any

import numpy as np

from coverage_matrix import cells
from estimators.batch import Batch
from fricmodels.drive import Drive
from fricmodels.errors import FricmodelsError
from fricmodels.model import Model

LARGER = ("exponential-stick-slip", "asymmetric-coulomb-viscous", "square-root", "asymmetric-exponential-stick-slip")


def fits() -> dict[str, Any]:
    """Return what would be printed of each fit: value and standard error by key, and why some are not identified."""
    found: dict[str, Any] = {}
    for k, cell in enumerate(cells()):
        for number in (0, 1):
            recording, own, drives = cell.recording(number), cell.drive, [cell.drive]
            if cell.effect == "none" and number:
                drives = [Drive(Model.parse(LARGER[k % 4]), own.inertia)]
            elif cell.effect == "none" and k % 5 == 0 and not cell.counts:
                drives.append(Drive(Model.parse("coulomb-viscous+stribeck"), None))
            for drive in drives:
                for way, settings in (("automatic", {}), ("alone", {"width": 32, "velocity": "measured"})):
                    try:
                        fit = Batch(settings).fit(drive, recording)
                    except FricmodelsError as error:
                        shown = [str(error)]
                    else:
                        errors = np.sqrt(np.clip(np.diag(fit.covariance), 0.0, None))
                        digits = {
                            key: f"{fit.parameters[key]:.3g} ± {error:.2g}"
                            for key, error in zip(fit.estimated, errors.tolist(), strict=True)
                        }
                        shown = [digits, dict(fit.not_identified)]
                    found[f"{cell.name}#{number} {drive.model.name} {way}"] = shown
    return found


def _fitted(environment: dict[str, str]) -> dict[str, Any]:
    """Return the fits of a process of its own."""
    command = [sys.executable, __file__, "--write"]
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kernels", default="Haswell", help="value of OPENBLAS_CORETYPE")
    parser.add_argument("--write", action="store_true", help="fit in this process, and write what was found")
    given = parser.parse_args()
    if given.write:
        json.dump(fits(), sys.stdout)
        return
    rest = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    here, there = _fitted(rest), _fitted({**rest, "OPENBLAS_CORETYPE": given.kernels})
    for name in here:
        if here[name] != there[name]:
            print(name, here[name], there[name], sep="\n    ")
    digits = sum(here[name][0] != there[name][0] for name in here)
    words = sum(here[name][1:] != there[name][1:] for name in here)
    print(f"{given.kernels}: of {len(here)} fits {digits} have other digits, {words} other words")


if __name__ == "__main__":
    main()
