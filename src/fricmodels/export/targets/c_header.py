"""A fitted model as one C99 header: law, effects, internal states, compensation. No allocation, no dependency."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable

from fricmodels.errors import InputError
from fricmodels.export.targets.c_filter import c_filter
from fricmodels.export.targets.c_text import KEYWORDS, ascii_text, c_names, comment, mentions
from fricmodels.export.targets.c_windowed import c_windowed
from fricmodels.export.targets.validity import doubtful
from fricmodels.filtering.problem import FilterProblem
from fricmodels.filtering.windowed import WindowedRegression
from fricmodels.kernels.c_source import c_lines, literal
from fricmodels.memory import first_states, memory_step
from fricmodels.recording import channel_of
from fricmodels.saved import FittedModel
from fricmodels.saved.words import error_in_words


def c_header(
    model: FittedModel, name: str = "friction", problem: FilterProblem | WindowedRegression | None = None
) -> str:
    r"""Return a header that computes what :class:`fricmodels.FittedModel` does.

    ``NAME_torque`` is τ_F, ``NAME_follow`` the same with internal states advanced by a sample, ``NAME_compensation``
    the torque that cancels friction, at rest as asked for. The formulas are those of Python, operation by operation.

    Args:
        model: to write.
        name: what every name in the header begins with.
        problem: of a filter that is to run beside the drive, see :func:`fricmodels.export.targets.c_filter.started`.

    Raises:
        InputError: for a name that is none in C.
    """
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) or name in KEYWORDS:
        raise InputError(f"'{name}' is no name in C; use letters, digits and _")
    if problem is None:
        return _Header(model, name).text()
    online = c_windowed(problem, name) if isinstance(problem, WindowedRegression) else c_filter(problem, name)
    return _Header(model, name).text([online])


class _Header:
    def __init__(self, model: FittedModel, name: str) -> None:
        self.model, self.name = model, name
        needed = [s for s in model.model.signals if s in model.needs or s == "velocity"]
        self.signals = dict(zip(needed, c_names(needed), strict=True))
        keys = [p.key for p in model.model.parameters]
        self.parameters = dict(zip(keys, c_names(keys), strict=True))
        self.states = bool(model.model.states)
        self.doubtful = doubtful(model)

    def text(self, more: Iterable[str] = ()) -> str:
        """Return the header; ``more`` stands at its end."""
        guard = f"{self.name.upper()}_H"
        parts = [
            self._opening(),
            f'#ifndef {guard}\n#define {guard}\n\n#include <math.h>\n\n#ifdef __cplusplus\nextern "C" {{\n#endif',
            self._constants(),
            self._structs(),
            self._torque(),
            *([self._follow()] if self.states else []),
            self._compensation(),
            *more,
            f"#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {guard} */",
        ]
        return "\n\n".join(parts) + "\n"

    # ---- what it says of itself -----------------------------------------------------------------------------------

    def _opening(self) -> str:
        model = self.model
        document = model.document
        lines = [f"{model.name}: friction of a {document.motion.value} drive, J dw/dt = tau_m - tau_L - tau_F.", ""]
        lines += [f"{term.name}: {term.equation}" for term in document.terms]
        lines += ["", f"Fitted to {document.provenance.recording}; {error_in_words(document)}."]
        lines += [
            f"  {seen_name}: {seen.least:.6g} to {seen.greatest:.6g} {seen.unit}"
            for seen_name, seen in document.range.items()
            if seen_name in {channel_of(s) for s in model.needs}
        ]
        for key, reason in self.doubtful.items():
            lines.append(f"NOT DETERMINED by the recording: {key}: {reason}.")
        lines += [f"{model.of_the_clock}."] if model.of_the_clock else []
        for term_name in model.memory.approximate if self.states else ():
            lines.append(f"{term_name}: in a loop its state follows its rate, in a recording it is looked up.")
        versions = document.provenance.versions
        lines += ["", f"Written by fricmodels {versions.get('fricmodels', '')}. All units SI. C99, libm only."]
        return comment(lines)

    def _constants(self) -> str:
        first = next(iter(self.model.document.parameters.items()))
        return "\n".join(
            [
                f"#define {self.name.upper()}_INERTIA {literal(first[1].value)} /* {first[0]} [{first[1].unit}] */",
                f"#define {self.name.upper()}_REST_WIDTH {literal(self.model.document.rest_width)}"
                f" /* below it the drive counts as at rest */",
            ]
        )

    def _structs(self) -> str:
        stored = self.model.document.parameters
        fields = [
            f"    double {c}; /* {key} [{stored[key].unit}] {ascii_text(stored[key].meaning)}"
            f"{' - NOT DETERMINED' if key in self.doubtful else ''} */"
            for key, c in self.parameters.items()
        ] or ["    double none; /* the model has no parameters */"]
        values = [f"    {literal(stored[key].value)}, /* {key} */" for key in self.parameters] or ["    0.0"]
        signals = [f"    double {c}; /* {ascii_text(name)} */" for name, c in self.signals.items()]
        text = [
            *(["typedef struct {", *fields, f"}} {self.name}_parameters;", ""]),
            *([f"static const {self.name}_parameters {self.name}_fitted = {{", *values, "};", ""]),
            *(["typedef struct {", *signals, f"}} {self.name}_signals;"]),
        ]
        if self.states:
            count = len(self.model.model.states)
            symbols = ", ".join(ascii_text(state.symbol) for state in self.model.model.states)
            initial = ", ".join(literal(state.initial) for state in self.model.model.states)
            text += [
                "",
                f"/* What is remembered between two samples: {symbols}. Begin with {self.name}_begin. */",
                "typedef struct {",
                f"    double z[{count}];",
                f"    {self.name}_signals last;",
                "    int begun;",
                f"}} {self.name}_state;",
                "",
                f"static inline {self.name}_state {self.name}_begin(void) {{",
                f"    {self.name}_state state = {{{{{initial}}}, {{{', '.join(['0.0'] * len(self.signals))}}}, 0}};",
                "    return state;",
                "}",
            ]
        return "\n".join(text)

    # ---- functions ------------------------------------------------------------------------------------------------

    def _inputs(self, signal: str) -> list[Callable[[int], str]]:
        """Return how signals, parameters, states and width are written, in the order of the expressions' inputs."""
        fields = list(self.parameters.values())
        return [
            *(
                _constant(f"{signal}{self.signals[s]}" if s in self.signals else "0.0")
                for s in self.model.model.signals
            ),
            lambda i: f"p->{fields[i]}",
            lambda i: f"z[{i}]",
            _constant(f"{self.name.upper()}_REST_WIDTH"),
        ]

    @property
    def _arguments(self) -> str:
        memory = ", const double *z" if self.states else ""
        return f"const {self.name}_parameters *p, const {self.name}_signals *s{memory}"

    def _torque(self) -> str:
        import casadi

        e = self.model.model.expression()
        function = casadi.Function(
            "torque", [*e.signals.values(), e.parameters, e.states, e.width], [e.torque], {"cse": True}
        )
        body = c_lines(function, self._inputs("s->"), [lambda i: "torque"])
        unused = [name for name in ("p", "s", *(["z"] if self.states else [])) if not mentions(body, name)]
        memory = ", z: the internal states" if self.states else ""
        return "\n".join(
            [
                f"/* The friction torque. p: parameters, such as &{self.name}_fitted; s: signals{memory}. */",
                f"static inline double {self.name}_torque({self._arguments}) {{",
                "    double torque;",
                *(f"    {line}" for line in body),
                *(f"    (void){name};" for name in unused),
                "    return torque;",
                "}",
            ]
        )

    def _first(self, signals: list[str], parameters: list[str]) -> list[str]:
        """Return what sets the states at the first sample; nothing where they are as declared."""
        function = first_states(self.model.model)
        if function is None:
            return []
        body = c_lines(
            function,
            [lambda i: signals[i], lambda i: f"p->{parameters[i]}"],
            [lambda i: f"state->z[{i}]"],
        )
        return ["    } else {", *(f"        {line}" for line in body)]

    def _follow(self) -> str:
        model = self.model.model
        needed = [s for s in model.signals if s in model.needs]
        fields = list(self.parameters.values())
        count = len(needed)

        def given(i: int) -> str:
            if i == 0:
                return "interval"
            of = "state->last." if i <= count else "s->"
            return of + self.signals[needed[(i - 1) % count]]

        constants = [*(f"p->{field}" for field in fields), f"{self.name.upper()}_REST_WIDTH"]
        body = c_lines(
            memory_step(model),
            [lambda i: f"state->z[{i}]", given, lambda i: constants[i]],
            [lambda i: f"following[{i}]"],
        )
        size = len(model.states)
        begun = self._first([f"s->{self.signals[name]}" for name in needed], fields)
        unused = [name for name in ("interval", "p") if not mentions([*body, *begun], name)]
        return "\n".join(
            [
                "/* The friction torque at the next sample of a motion, an interval [s] after the last one. */",
                f"static inline double {self.name}_follow(const {self.name}_parameters *p, {self.name}_state *state,",
                f"                                        double interval, const {self.name}_signals *s) {{",
                "    if (state->begun) {",
                f"        double following[{size}];",
                *(f"        {line}" for line in body),
                *(f"        state->z[{i}] = following[{i}];" for i in range(size)),
                *begun,
                "    }",
                *(f"    (void){name};" for name in unused),
                "    state->last = *s;",
                "    state->begun = 1;",
                f"    return {self.name}_torque(p, s, state->z);",
                "}",
            ]
        )

    def _compensation(self) -> str:
        up, memory = self.name.upper(), ", z" if self.states else ""
        return textwrap.dedent(f"""\
            /* What to do at rest: hold a weight only, take the direction of the reference, or turn over smoothly. */
            typedef enum {{ {up}_AT_REST_NONE, {up}_AT_REST_REFERENCE, {up}_AT_REST_SMOOTH }} {self.name}_at_rest;

            /* The torque to add so that friction is cancelled. Inertia and load are not in it.
               reference: the velocity that is wanted next, for {up}_AT_REST_REFERENCE; width: speed of rest, or of the
               turn, greater than 0. */
            static inline double {self.name}_compensation({self._arguments},
                                                  {self.name}_at_rest at_rest, double reference, double width) {{
                const double tiny = {literal(1e-9)} * {up}_REST_WIDTH;
                {self.name}_signals side = *s;
                double above, below, direction;
                side.velocity = fmax(s->velocity, tiny);
                above = {self.name}_torque(p, &side{memory});
                side.velocity = fmin(s->velocity, -tiny);
                below = {self.name}_torque(p, &side{memory});
                if (at_rest == {up}_AT_REST_SMOOTH) {{
                    direction = tanh(s->velocity / width);
                }} else if (fabs(s->velocity) > width) {{
                    direction = (s->velocity > 0.0) ? 1.0 : -1.0;
                }} else if (at_rest == {up}_AT_REST_REFERENCE) {{
                    direction = (double)((reference > 0.0) - (reference < 0.0));
                }} else {{
                    direction = 0.0;
                }}
                return (above * (1.0 + direction) + below * (1.0 - direction)) / 2.0;
            }}""")


def _constant(text: str) -> Callable[[int], str]:
    return lambda i: text
