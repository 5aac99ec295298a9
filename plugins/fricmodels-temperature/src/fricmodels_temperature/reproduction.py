"""What is printed of the law beside what this law gives: three coefficients, a curve, and a figure.

``python -m fricmodels_temperature.reproduction [friction.png]`` prints the comparison and, given a file, draws the
figure, which needs matplotlib (``pip install "fricmodels[report]"``).
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fricmodels.files import replaced
from fricmodels.model import Model
from fricmodels_temperature import printed
from fricmodels_temperature.joint import Array, friction
from fricmodels_temperature.law import FreeExponent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FIGURE_LOADS = (0.0, 1000.0, 2000.0, 3000.0, 4000.0, 5000.0, 6000.0)
"""[N m], at 40 °C."""
FIGURE_TEMPERATURES = (40.0, 50.0, 60.0, 70.0)
"""[°C], at 500 N m."""
_REST = 1e-9
"""So slow that the friction is that of a joint about to stop [rad/s]."""


def closed_form(speed: Array) -> Array:
    """Return the printed friction torque [N m] at positive speeds [rad/s] of the joint: 35 °C, 1000 N m."""
    near_rest = np.exp(-((speed / printed.STRIBECK_SPEED) ** printed.EXPONENT))
    return np.asarray(printed.COULOMB + printed.STRIBECK * near_rest + printed.VISCOUS * speed)


def coefficients(values: Mapping[str, float] = printed.JOINT_SIDE) -> tuple[float, float, float]:
    """Return the Coulomb [N m], Stribeck [N m] and viscous [N m s/rad] coefficients that the law's curve shows.

    They are read off the friction at 35 °C and 1000 N m: slope and intercept at speed, and what is more at rest.
    """
    speeds = np.array([_REST, 2.0, 3.0])
    at_rest, slower, faster = friction(speeds, printed.CASE_LOAD, printed.CASE_TEMPERATURE, values)
    slope = faster - slower
    intercept = slower - slope * speeds[1]
    return float(intercept), float(at_rest - intercept), float(slope)


def largest_difference(values: Mapping[str, float] = printed.JOINT_SIDE, exponent: float = printed.EXPONENT) -> float:
    """Return the largest difference [N m] between the law and the printed curve, 10⁻⁴ to 2 rad/s."""
    speeds = np.geomspace(1e-4, 2.0, 4000)
    every = {**values, "alpha": exponent}
    law = friction(speeds, printed.CASE_LOAD, printed.CASE_TEMPERATURE, every, Model(FreeExponent()))
    return float(np.max(np.abs(law - closed_form(speeds))))


def at_the_joint(values: Mapping[str, float] = printed.MOTOR_SIDE) -> dict[str, float]:
    """Return parameters of the motor's side in terms of the joint: N m and rad/s."""
    torque = printed.LARGEST_MOTOR_TORQUE * printed.GEAR_RATIO
    units = {
        "F_c0": torque, "F_s0": torque, "F_sT": torque, "phi_sl": 1 / printed.GEAR_RATIO,
        "phi_s0": 1 / printed.GEAR_RATIO, "phi_sT": 1 / printed.GEAR_RATIO,
        "F_v0": torque * printed.GEAR_RATIO, "F_vT": torque * printed.GEAR_RATIO,
    }  # fmt: skip
    return {key: value * units.get(key, 1.0) for key, value in values.items()}


def save_figure(file: Path) -> None:
    """Draw friction over speed at several loads and at several temperatures into a PNG file."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    speeds = np.linspace(1e-5, 1.0, 1000)
    _curves(left, speeds, [(load, 40.0, f"{load:g} N m") for load in FIGURE_LOADS], "40 °C, load torque")
    _curves(right, speeds, [(500.0, warm, f"{warm:g} °C") for warm in FIGURE_TEMPERATURES], "500 N m, temperature")
    with replaced(file) as beside:
        figure.savefig(beside, format="png", dpi=90, metadata={"Software": None})


def _curves(axes: Axes, speeds: Array, cases: Sequence[tuple[float, float, str]], title: str) -> None:
    from matplotlib import colormaps

    colour_map = colormaps["viridis_r"]
    for i, (load, temperature, label) in enumerate(cases):
        colour = colour_map(i / (len(cases) - 1))
        axes.plot(speeds, friction(speeds, load, temperature, printed.JOINT_SIDE), color=colour, label=label)
    axes.set(xlabel="speed of the joint [rad/s]", ylabel="friction torque [N m]", xlim=(0, 1), ylim=(0, 1500))
    axes.legend(title=title, fontsize="small", ncols=2)


def main(arguments: Sequence[str]) -> None:
    """Print printed values beside the law's; draw the figure if a file is named."""
    given = (printed.COULOMB, printed.STRIBECK, printed.VISCOUS)
    print("35 °C, 1000 N m | printed | this law\n---|---|---")
    for name, there, here in zip(("Coulomb", "Stribeck", "viscous"), given, coefficients(), strict=True):
        print(f"{name} | {there:g} | {here:.3f}")
    for alpha in (1.36, 1.3):
        for side, values in (("joint side as printed", printed.JOINT_SIDE), ("motor side converted", at_the_joint())):
            difference = largest_difference(values, alpha)
            print(f"largest difference from the printed curve, α = {alpha:g}, {side}: {difference:.2f} N m")
    for name in arguments:
        save_figure(Path(name))


if __name__ == "__main__":
    main(sys.argv[1:])
