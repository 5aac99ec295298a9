"""A filter beside a drive in C99: ``ekf`` or ``detchmendy-sridhar``, one sample at a time, no allocation."""

from __future__ import annotations

import numpy as np

from fricmodels.dimension import DIMENSIONLESS, VELOCITY
from fricmodels.errors import EstimationError, InputError
from fricmodels.export.targets.c_text import ascii_text, c_names, comment, step, table
from fricmodels.filtering.covariance import pack
from fricmodels.filtering.online import ProblemOnline, resting_speed
from fricmodels.filtering.problem import FilterProblem
from fricmodels.filtering.windowed import Windowed, WindowedRegression
from fricmodels.kernels.c_source import literal
from fricmodels.recording import Recording
from fricmodels.saved import FittedModel
from fricmodels.term import SIGNALS


def started(model: FittedModel, estimator: str, recording: Recording) -> FilterProblem | WindowedRegression:
    """Return the filter of a model, scaled and started for drives that move like a recording.

    Raises:
        InputError: for an estimator that cannot be written in C.
    """
    from fricmodels import plugins
    from fricmodels.estimator import SequentialEstimator
    from fricmodels.weakform.prepared import ready

    made = plugins.load().estimators[estimator]()
    # Its samples are as they are measured, and so is the noise that it is tuned to: a surer velocity is not theirs.
    seen = recording if recording.measures("velocity") else ready(recording)
    try:
        online = made.start(model.drive, seen) if isinstance(made, SequentialEstimator) else None
    except EstimationError as error:
        raise InputError(str(error)) from None
    if isinstance(online, Windowed):
        return online.windowed
    if not isinstance(online, ProblemOnline):
        raise InputError(f"'{estimator}' cannot be written in C; ekf, detchmendy-sridhar and rls can")
    return online.problem


def c_filter(problem: FilterProblem, name: str) -> str:
    """Return declarations and functions of a filter; it does what its ``update`` does in Python.

    ``NAME_online_begin`` starts it, ``NAME_online_update`` takes a sample (SI) and ``NAME_online_parameter`` reads the
    estimate. Whole and exact state: copy the struct.

    Args:
        problem: the filter before its first sample. name: what every name begins with.
    """
    return "\n\n".join([_opening(problem), *_Writer(problem, name).parts()])


def _opening(problem: FilterProblem) -> str:
    keys = ", ".join(f"{i}: {key}" for i, key in enumerate(problem.drive.keys))
    return comment(
        [
            f"The filter on line. Parameters, in this order: {keys}.",
            f"It holds {problem.order} numbers and their covariance; {problem.substeps} steps between two samples.",
            "Samples must have increasing times. Rest of more than a cycle teaches nothing and forgets nothing.",
        ]
    )


class _Writer:
    def __init__(self, problem: FilterProblem, name: str) -> None:
        self.problem, self.name = problem, name
        self.inputs = dict(zip(problem.space.inputs, c_names(problem.space.inputs), strict=True))
        self.size = problem.order + problem.order * (problem.order + 1) // 2

    def parts(self) -> list[str]:
        """Return the pieces of the header in order."""
        return [
            self._tables(),
            self._structs(),
            self._begin(),
            self._restart(),
            self._step(),
            self._update(),
            self._read(),
        ]

    def _tables(self) -> str:
        problem, n = self.problem, self.name
        scales = [problem.scales.of(SIGNALS.get(s, DIMENSIONLESS)) for s in self.inputs]
        return "\n".join(
            [
                table(f"{n}_online_constants", problem.constants),
                table(f"{n}_online_first", problem.initial_memory()),
                table(f"{n}_online_scales", scales or [1.0]),
                table(f"{n}_online_units", problem.drive.parameter_scales(problem.scales)),
            ]
        )

    def _structs(self) -> str:
        n = self.name
        fields = [f"    double {c}; /* {ascii_text(s)} */" for s, c in self.inputs.items()]
        time = [] if "time" in self.inputs else ["    double time; /* [s] */"]
        return "\n".join(
            [
                "typedef struct {",
                *time,
                "    double velocity; /* as measured */",
                *fields,
                f"}} {n}_online_sample;",
                "",
                "typedef struct {",
                f"    double memory[{self.size}];",
                f"    double constants[{len(self.problem.constants)}];",
                f"    {n}_online_sample last;",
                "    double rested;",
                "    int begun;",
                f"}} {n}_online;",
            ]
        )

    def _begin(self) -> str:
        n = self.name
        return f"""static inline void {n}_online_begin({n}_online *filter) {{
    int i;
    for (i = 0; i < {self.size}; i++) filter->memory[i] = {n}_online_first[i];
    for (i = 0; i < {len(self.problem.constants)}; i++) filter->constants[i] = {n}_online_constants[i];
    filter->rested = 0.0;
    filter->begun = 0;
}}"""

    def _restart(self) -> str:
        """Write what happens at the first sample of a run: motion anew, parameters and their covariance carried on."""
        problem, n = self.problem, self.name
        order, moving = problem.order, problem.moving
        first = pack(problem.initial_covariance)
        lines = [f"    filter->memory[{i}] = {literal(float(problem.initial_states[i]))};" for i in range(1, moving)]
        for k, (i, j) in enumerate(zip(*np.tril_indices(order), strict=True)):
            if j < moving:
                value = float(first[k]) if i < moving else 0.0
                lines.append(f"    filter->memory[{order + k}] = {literal(value)};")
        speed = literal(problem.scales.of(VELOCITY))
        return "\n".join(
            [
                "/* At the first sample of a run: velocity as measured, the parameters are carried on. */",
                f"static inline void {n}_online_restart({n}_online *filter, const {n}_online_sample *s) {{",
                f"    filter->memory[0] = s->velocity / {speed};",
                *lines,
                "    filter->last = *s;",
                "    filter->begun = 1;",
                "}",
            ]
        )

    def _step(self) -> str:
        places = [lambda i: f"memory[{i}]", lambda i: f"row[{i}]", lambda i: f"constants[{i}]"]
        return step(self.name, self.problem.scan.function, ["memory", "row", "constants"], places)

    def _update(self) -> str:
        problem, n = self.problem, self.name
        walks, cycle = len(problem.known) + 1, 2 * np.pi * problem.scales.time
        rest = literal(resting_speed(problem))
        inputs = []
        for i, (signal, field) in enumerate(self.inputs.items()):
            held = signal == "motor_torque" and problem.hold == "held"
            last, scale = f"filter->last.{field}", f"{n}_online_scales[{i}]"
            if held:
                inputs.append(f"        row[{3 + i}] = {last} / {scale};")
            else:
                now = f"s->{field} / {scale}"
                inputs.append(f"        row[{3 + i}] = {last} / {scale} * (1.0 - part) + {now} * part;")
        parameters = range(walks + problem.moving, walks + problem.order)
        return "\n".join(
            [
                "/* Take a sample. */",
                f"static inline void {n}_online_update({n}_online *filter, const {n}_online_sample *s) {{",
                f"    double row[{3 + len(self.inputs)}], next[{self.size}], interval;",
                "    int k, i, still;",
                "    if (!filter->begun) {",
                f"        {n}_online_restart(filter, s);",
                "        return;",
                "    }",
                "    interval = s->time - filter->last.time;",
                f"    still = fabs(s->velocity) <= {rest} && fabs(filter->last.velocity) <= {rest};",
                "    filter->rested = still ? filter->rested + s->time - filter->last.time : 0.0;",
                f"    still = filter->rested > {literal(float(cycle))};",
                *(
                    f"    filter->constants[{i}] = still ? 0.0 : {n}_online_constants[{i}];"
                    for i in parameters
                    if problem.constants[i] != 0.0
                ),
                f"    for (k = 0; k < {problem.substeps}; k++) {{",
                f"        const double part = (k + 0.5) / {literal(float(problem.substeps))};",
                f"        row[0] = interval / {literal(problem.scales.time)} / {literal(float(problem.substeps))};",
                f"        row[1] = (k == {problem.substeps - 1}) ? interval / {literal(problem.scales.time)} : 0.0;",
                f"        row[2] = s->velocity / {literal(problem.scales.of(VELOCITY))};",
                *inputs,
                *([] if self.inputs else ["        (void)part;"]),
                f"        {n}_online_step(filter->memory, row, filter->constants, next);",
                f"        for (i = 0; i < {self.size}; i++) filter->memory[i] = next[i];",
                "    }",
                "    filter->last = *s;",
                "}",
            ]
        )

    def _read(self) -> str:
        n = self.name
        return f"""/* The present estimate of parameter i, SI. */
static inline double {n}_online_parameter(const {n}_online *filter, int i) {{
    return filter->memory[{self.problem.moving} + i] * {n}_online_units[i];
}}"""
