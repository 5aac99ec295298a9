"""Recursive least squares beside a drive in C99: one sample at a time, no allocation."""

from __future__ import annotations

from fricmodels.drive import SHARE_OF_REST
from fricmodels.errors import InputError
from fricmodels.export.targets.c_text import ascii_text, c_names, comment, mentions, step, table
from fricmodels.filtering.windowed import RESTING, WindowedRegression
from fricmodels.kernels.c_source import c_lines, literal

_ALWAYS = ("motor_torque", "load_torque")


def c_windowed(problem: WindowedRegression, name: str) -> str:
    """Return declarations and functions of recursive least squares; it does what its ``update`` does in Python.

    ``NAME_online_begin`` starts it, ``NAME_online_update`` takes a sample (SI), ``NAME_online_restart`` says that the
    next one does not follow the last, and ``NAME_online_parameter`` reads the estimate.

    Args:
        problem: before the first sample. name: what every name begins with.

    Raises:
        InputError: for a model that needs the rate of the motor torque.
    """
    model = problem.drive.model
    if "motor_torque_rate" in model.needs:
        raise InputError(f"'{model.name}' needs the rate of the motor torque, which rls in C does not have; use ekf")
    return "\n\n".join([_opening(problem), *_Writer(problem, name).parts()])


def _opening(problem: WindowedRegression) -> str:
    keys = ", ".join(f"{i}: {key}" for i, key in enumerate(problem.drive.keys))
    held = ", ".join(key for key in problem.drive.keys if key in problem.fixed)
    return comment(
        [
            f"Recursive least squares on line. Parameters, in this order: {keys}.",
            *([f"Held, not estimated: {held}."] if held else []),
            f"Each sample closes a window of {problem.window} samples, smoothed over {len(problem.value)}.",
            "Samples must have increasing times. Windows with standstill teach nothing and forget nothing.",
        ]
    )


class _Writer:
    def __init__(self, problem: WindowedRegression, name: str) -> None:
        self.problem, self.name = problem, name
        model = problem.drive.model
        given = {s for s in model.signals if s in {*model.needs, *_ALWAYS}} - {"velocity", "acceleration", "time"}
        signals = [s for s in model.signals if s in given]
        self.inputs = dict(zip(signals, c_names(signals), strict=True))
        self.order = len(problem.keys)
        self.size = self.order + self.order * (self.order + 1) // 2
        self.columns = sum(model.linear)
        self.span, self.half = len(problem.value), len(problem.value) // 2
        self.estimates_inertia = problem.drive.inertia_key in problem.keys

    def parts(self) -> list[str]:
        """Return the pieces of the header in order."""
        return [self._tables(), self._structs(), self._begin(), self._regressors(), self._step(), *self._update()]

    def _tables(self) -> str:
        problem, n = self.problem, self.name
        places = [float(problem.keys.index(k)) if k in problem.keys else -1.0 for k in problem.drive.keys]
        fixed = [problem.fixed.get(key, 0.0) for key in problem.drive.keys]
        return "\n".join(
            [
                table(f"{n}_online_first", problem.memory),
                table(f"{n}_online_value", problem.value),
                table(f"{n}_online_slope", problem.slope),
                table(f"{n}_online_sizes", problem.size),
                table(f"{n}_online_fixed", fixed),
                f"static const int {n}_online_places[{len(places)}] = {{{', '.join(str(int(p)) for p in places)}}};",
            ]
        )

    def _structs(self) -> str:
        n, fields = self.name, [f"    double {c}; /* {ascii_text(s)} */" for s, c in self.inputs.items()]
        return "\n".join(
            [
                "typedef struct {",
                "    double time; /* [s] */",
                "    double velocity; /* as measured */",
                *fields,
                f"}} {n}_online_sample;",
                "",
                "/* What is kept of a sample in the window: regressors, what they are to explain, and its motion. */",
                "typedef struct {",
                f"    double column[{max(self.columns, 1)}];",
                "    double right, time, measured, velocity;",
                "    int slow;",
                f"}} {n}_online_kept;",
                "",
                "typedef struct {",
                f"    double memory[{self.size}];",
                f"    {n}_online_sample sample[{self.span}];",
                f"    {n}_online_kept kept[{self.problem.window}];",
                "    int samples, next_sample, rows, next_row;",
                f"}} {n}_online;",
            ]
        )

    def _begin(self) -> str:
        n = self.name
        return f"""/* The next sample does not follow the last one: the window begins anew, what was learnt stays. */
static inline void {n}_online_restart({n}_online *filter) {{
    filter->samples = filter->next_sample = filter->rows = filter->next_row = 0;
}}

static inline void {n}_online_begin({n}_online *filter) {{
    int i;
    for (i = 0; i < {self.size}; i++) filter->memory[i] = {n}_online_first[i];
    {n}_online_restart(filter);
}}"""

    def _regressors(self) -> str:
        problem, n = self.problem, self.name
        model = problem.drive.model
        function = problem.drive.linear_function
        own = {"velocity": "velocity", "acceleration": "acceleration", "time": "s->time"}
        written = {s: own.get(s, f"s->{self.inputs[s]}" if s in self.inputs else "0.0") for s in model.signals}
        values = [literal(float(value)) for value in model.nonlinear_of(problem.fixed)]
        width = literal(SHARE_OF_REST / RESTING * problem.resting)
        body = c_lines(
            function,
            [
                *((lambda i, text=text: text) for text in written.values()),
                lambda i: values[i],
                lambda i: "0.0",
                lambda i: width,
            ],
            [lambda i: f"column[{i}]", lambda i: "*offset"],
        )
        unused = [v for v in ("s", "velocity", "acceleration", "column") if not mentions(body, v)]
        return "\n".join(
            [
                f"static inline void {n}_online_regressors(const {n}_online_sample *s, double velocity,",
                "    double acceleration, double *column, double *offset) {",
                *(f"    {line}" for line in body),
                *(f"    (void){name};" for name in unused),
                "}",
            ]
        )

    def _step(self) -> str:
        places = [
            lambda i: f"memory[{i}]",
            lambda i: "1.0" if i == self.order + 1 else f"row[{i}]",
            lambda i: literal(self.problem.forgetting),
        ]
        return step(self.name, self.problem.step, ["memory", "row"], places)

    def _update(self) -> list[str]:
        problem, n = self.problem, self.name
        window, span, columns = problem.window, self.span, self.columns
        inertia = problem.fixed.get(problem.drive.inertia_key, 0.0)
        first = 1 if self.estimates_inertia else 0
        each = [f"        sum[{c}] += sided * k->column[{c}];" for c in range(columns)]
        scaled = [
            f"    row[{c + first}] = sum[{c}] / total * {n}_online_sizes[{c + first}] / {literal(problem.torque)};"
            for c in range(columns)
        ]
        if self.estimates_inertia:
            scaled.insert(0, f"    row[0] = -inertial / total * {n}_online_sizes[0] / {literal(problem.torque)};")
            right = "right / total"
        else:
            right = f"(right / total + {literal(float(inertia))} * inertial / total)"
        take = f"""/* Smooth the sample that now has neighbours on both sides, and keep it for the window. */
static inline int {n}_online_take({n}_online *filter, const {n}_online_sample *s) {{
    double velocity = 0.0, change = 0.0, acceleration, offset;
    const {n}_online_sample *oldest, *middle;
    {n}_online_kept *k = &filter->kept[filter->next_row];
    int i, j;
    filter->sample[filter->next_sample] = *s;
    if (++filter->next_sample == {span}) filter->next_sample = 0;
    if (filter->samples < {span}) filter->samples++;
    if (filter->samples < {span}) return 0;
    j = filter->next_sample;
    oldest = &filter->sample[j];
    for (i = 0; i < {span}; i++) {{
        velocity += {n}_online_value[i] * filter->sample[j].velocity;
        change += {n}_online_slope[i] * filter->sample[j].velocity;
        if (++j == {span}) j = 0;
    }}
    acceleration = change / ((s->time - oldest->time) / {literal(float(span - 1))});
    j = filter->next_sample + {self.half};
    middle = &filter->sample[j < {span} ? j : j - {span}];
    {n}_online_regressors(middle, velocity, acceleration, k->column, &offset);
    k->right = middle->motor_torque - middle->load_torque - offset;
    k->time = middle->time;
    k->measured = middle->velocity;
    k->velocity = velocity;
    k->slow = fabs(velocity) < {literal(problem.resting)};
    if (++filter->next_row == {window}) filter->next_row = 0;
    if (filter->rows < {window}) filter->rows++;
    return filter->rows == {window};
}}"""
        update = "\n".join(
            [
                "/* Take a sample. */",
                f"static inline void {n}_online_update({n}_online *filter, const {n}_online_sample *s) {{",
                f"    double row[{self.order + 1}], next[{self.size}], sum[{max(columns, 1)}] = {{0.0}};",
                "    double total = 0.0, right = 0.0, inertial = 0.0, begin, scale, before = 0.0, shifted = 0.0;",
                "    int i, j, standing = 0;",
                f"    if (!{n}_online_take(filter, s)) return;",
                f"    j = filter->next_row == 0 ? {window - 1} : filter->next_row - 1;",
                "    begin = filter->kept[filter->next_row].time;",
                "    scale = 2.0 / (filter->kept[j].time - begin);",
                "    j = filter->next_row;",
                f"    for (i = 0; i < {window}; i++) {{",
                f"        const {n}_online_kept *k = &filter->kept[j], *later;",
                "        double after = 0.0, shift = 0.0, at = (k->time - begin) * scale - 1.0, rest = 1.0 - at * at;",
                "        double measure, shape = rest * rest * rest, sided;",
                f"        j = j == {window - 1} ? 0 : j + 1;",
                f"        if (i < {window - 1}) {{",
                "            later = &filter->kept[j];",
                "            after = later->time - k->time;",
                "            standing |= k->slow && later->slow;",
                "            if ((k->velocity < 0.0) != (later->velocity < 0.0)) {",
                "                const double size = fabs(k->velocity);",
                "                shift = after * (size / (size + fabs(later->velocity)) - 0.5);",
                "            }",
                "        }",
                "        measure = 0.5 * (before + after);",
                "        sided = shape * (measure + shift - shifted);",
                "        inertial += 6.0 * at * rest * rest * scale * measure * k->measured;",
                "        measure *= shape;",
                "        total += measure;",
                "        right += measure * k->right;",
                *each,
                "        before = after;",
                "        shifted = shift;",
                "    }",
                "    if (standing) return;",
                "    inertial = -inertial;",
                *scaled,
                f"    row[{self.order}] = {right} / {literal(problem.torque)};",
                *([] if columns else ["    (void)sum;"]),
                f"    {n}_online_step(filter->memory, row, next);",
                f"    for (i = 0; i < {self.size}; i++) filter->memory[i] = next[i];",
                "}",
            ]
        )
        read = f"""/* The present estimate of parameter i, SI. */
static inline double {n}_online_parameter(const {n}_online *filter, int i) {{
    const int place = {n}_online_places[i];
    return place < 0 ? {n}_online_fixed[i] : filter->memory[place] * {n}_online_sizes[place];
}}"""
        return [take, update, read]
