"""What a tournament is: recordings × models × estimators, and how they are scored. Written in YAML."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from fricmodels import plugins
from fricmodels.dimension import Motion
from fricmodels.documents import Document, NotNegative, Positive, read_yaml, validate
from fricmodels.errors import InputError
from fricmodels.gaps import Gaps
from fricmodels.motion.controllers import AnyController
from fricmodels.signals import Preparation
from fricmodels.split import Split

ALL = "all"
Ranking = Literal[
    "held_out_rms_torque_error_percent",
    "held_out_rms_torque_error",
    "rms_torque_error_percent",
    "rms_torque_error",
    "simulated_position_error",
    "simulated_position_error_percent",
    "simulated_velocity_error",
    "simulated_velocity_error_percent",
    "tracking_error_percent",
    "aic",
    "bic",
    "seconds",
]
"""Columns of the leaderboard that may decide the rank; the smallest comes first."""


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, list | tuple) else [value]


def _run_names(value: Any) -> Any:
    return [str(item) if isinstance(item, int) else item for item in _listed(value)]


def _folder_name(name: str) -> str:
    """Refuse a name that, as a folder below ``runs``, would be somewhere else."""
    if (
        not name.strip()
        or name.startswith(".")
        or len(name) > 100
        or any(c in "/\\" or not c.isprintable() for c in name)
    ):
        raise ValueError("it names the folder of the results: 1 to 100 characters, no / or \\, and no dot in front")
    return name


def _not_zero(value: float) -> float:
    if value == 0.0:
        raise ValueError("a motor whose torque constant is 0 makes no torque")
    return value


def _estimator(value: Any) -> Any:
    return {"name": value} if isinstance(value, str) else value


MOST_RECORDINGS = 100_000
"""Of one dataset, or seeds of one: more is taken for a slip of the pen."""
MOST_SAMPLES = 20_000_000
"""Of one simulated recording; it takes some GB to make."""


def _counted(value: Any) -> Any:
    """Take ``seeds: 20`` as the seeds 0 … 19."""
    if isinstance(value, int) and not isinstance(value, bool) and value > 0:
        if value > MOST_RECORDINGS:
            raise ValueError(f"{value:.3g} seeds are more than {MOST_RECORDINGS}, each a recording of its own")
        return list(range(value))
    return _listed(value)


_SOME = Field(min_length=1)
_Seed = Annotated[int, Field(ge=0)]
# Where one value may be written for a list, the JSON Schema says so: `json_schema_input_type`.
Texts = Annotated[list[str], BeforeValidator(_listed, json_schema_input_type=str | Annotated[list[str], _SOME]), _SOME]
Positives = Annotated[
    list[Positive],
    BeforeValidator(_listed, json_schema_input_type=Positive | Annotated[list[Positive], _SOME]),
    _SOME,
]
Percentages = Annotated[
    list[NotNegative],
    BeforeValidator(_listed, json_schema_input_type=NotNegative | Annotated[list[NotNegative], _SOME]),
    _SOME,
]
Seeds = Annotated[
    list[_Seed], BeforeValidator(_counted, json_schema_input_type=_Seed | Annotated[list[_Seed], _SOME]), _SOME
]
Runs = Annotated[
    list[str],
    BeforeValidator(_run_names, json_schema_input_type=str | int | Annotated[list[str | int], _SOME]),
    _SOME,
]


class Closed(BaseModel):
    """A section of the configuration; keys that it does not know are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Simulate(Closed):
    """A drive whose parameters are known, under a sinusoidal torque, with white noise on its velocity.

    ``amplitude``, ``frequency``, ``noise_percent`` and ``seeds`` may be lists: every combination is one recording.
    """

    model: str = Field(description="LAW+EFFECT… that moves the simulated drive")
    parameters: dict[str, float] = Field(description="true value of every parameter of the model, SI")
    inertia: float = Field(gt=0, allow_inf_nan=False, description="J [kg m²] or M [kg]")
    amplitude: Positives = Field(description="amplitude of the torque [N m or N]")
    frequency: Positives = Field(description="angular frequency of the torque [rad/s]")
    cycles: int = Field(default=10, ge=1)
    samples_per_cycle: int = Field(default=200, ge=8)
    noise_percent: Percentages = Field(default=[0.0], description="standard deviation of the noise, % of RMS velocity")
    seeds: Seeds = Field(default=[0], description="seeds of the noise; a number n stands for 0 … n−1")
    quantisation: float = Field(default=0.0, ge=0, allow_inf_nan=False, description="smallest step of the velocity")
    hold: int = Field(default=1, ge=1, description="the velocity sensor gives a value every so many samples")
    between_samples: Literal["linear", "held"] = "linear"

    @model_validator(mode="after")
    def _bounded(self) -> Simulate:
        samples = self.cycles * self.samples_per_cycle
        if samples > MOST_SAMPLES:
            raise ValueError(f"{samples:.3g} samples of one recording are more than {MOST_SAMPLES}; take fewer cycles")
        recordings = math.prod(len(each) for each in (self.amplitude, self.frequency, self.noise_percent, self.seeds))
        if recordings > MOST_RECORDINGS:
            raise ValueError(f"all combinations are {recordings} recordings, more than {MOST_RECORDINGS}")
        return self


class Dataset(Closed):
    """Where recordings come from: ``files``, a ``simulate`` section or a ``rig`` file; exactly one of them."""

    name: str | None = None
    files: Texts | None = Field(default=None, description="paths or globs, relative to this file")
    test_files: Texts | None = Field(default=None, description="score on these files what was fitted on `files`")
    together: bool = Field(default=False, description="take all files as one recording, each a run of it")
    optional: bool = Field(default=False, description="leave the dataset out, with a message, when no file is there")
    simulate: Simulate | None = None
    rig: str | None = Field(default=None, description="rig file, relative to this file")
    seeds: Seeds = Field(default=[0], description="seeds of the rig")
    reader: str | None = None
    columns: dict[str, str | dict[str, str]] = Field(
        default={}, description="CHANNEL: COLUMN[:UNIT]; further channels by their names under other"
    )
    motion: Motion | None = None
    inertia: float | None = Field(
        default=None, gt=0, allow_inf_nan=False, description="J [kg m²] or M [kg]; left out, it is estimated"
    )
    estimate_inertia: bool = Field(default=False, description="estimate the inertia of a simulated drive too")
    torque_constant: Annotated[float, AfterValidator(_not_zero)] | None = Field(
        default=None, allow_inf_nan=False, description="N m/A or N/A; negative where the current counts the other way"
    )
    gaps: Gaps | None = Field(
        default=None,
        description="rows without numbers: drop them, split into runs, or join channels in rows of their own",
    )
    runs: Runs | None = Field(default=None, description="numbers or names of the runs to use; all by default")
    preparation: Preparation | None = None
    split: Split | None = None

    @model_validator(mode="after")
    def _one_source(self) -> Dataset:
        given = [key for key in ("files", "simulate", "rig") if getattr(self, key) is not None]
        if len(given) != 1:
            found = f"both '{given[0]}' and '{given[1]}'" if given else "none"
            raise ValueError(f"give one of 'files', 'simulate' and 'rig', found {found}")
        if self.test_files is not None and self.files is None:
            raise ValueError("'test_files' goes with 'files'")
        if self.together and self.files is None:
            raise ValueError("'together' goes with 'files'")
        return self


class Entrant(Closed):
    """An estimator that takes part, and its settings."""

    name: str
    settings: dict[str, Any] = {}
    label: str | None = Field(default=None, description="how it is called in the leaderboard")

    @property
    def title(self) -> str:
        """The label, or the name."""
        return self.label or self.name


Entrants = Annotated[
    list[Annotated[Entrant, BeforeValidator(_estimator)]],
    BeforeValidator(_listed, json_schema_input_type=str | Entrant | Annotated[list[str | Entrant], _SOME]),
    _SOME,
]


class Config(Closed):
    """One tournament.

    ``models`` and ``estimators`` may say ``all``: every registered law, every registered estimator.
    """

    name: Annotated[str, AfterValidator(_folder_name)] = "tournament"
    datasets: list[Dataset] = Field(min_length=1)
    models: Texts = [ALL]
    estimators: Entrants = [Entrant(name=ALL)]
    score: Literal["held-out", "paper", "position", "tracking"] = "held-out"
    horizon: int | None = Field(
        default=None, ge=1, description="with score: position, samples after which a simulation starts anew"
    )
    controller: AnyController | None = Field(
        default=None, description="with score: position, what drives the simulation in place of the recorded torque"
    )
    decimate: int = Field(default=1, ge=1, description="score every so many-th sample, low-pass filtered")
    simulate: bool = Field(default=True, description="score the simulated velocity too")
    rank_by: Ranking | None = None
    preparation: Preparation = Preparation()
    split: Split = Split()
    timeout: float = Field(default=120.0, gt=0, allow_inf_nan=False, description="seconds for one fit")
    jobs: int | None = Field(default=None, ge=1, description="processes; left out, one a core")

    @model_validator(mode="after")
    def _of_the_score(self) -> Config:
        if self.score == "tracking" and any(dataset.rig is None for dataset in self.datasets):
            raise ValueError("'score: tracking' drives simulated drives; give every dataset a 'rig'")
        for key in ("horizon", "controller"):
            if getattr(self, key) is not None and self.score != "position":
                raise ValueError(f"'{key}' goes with score: position")
        return self

    @property
    def ranking(self) -> str:
        """The column that decides the rank."""
        if self.score == "position":
            return str(self.rank_by or "simulated_position_error")
        paper = "rms_torque_error_percent"
        if self.score == "tracking":
            return str(self.rank_by or "tracking_error_percent")
        return str(self.rank_by or (paper if self.score == "paper" else f"held_out_{paper}"))

    @property
    def entrants(self) -> tuple[Entrant, ...]:
        """The estimators that take part, ``all`` spelled out."""
        registered = plugins.load().estimators
        listed: list[Entrant] = []
        for entrant in self.estimators:
            names = [*registered, *registered.lost] if entrant.name == ALL else [entrant.name]
            listed.extend(entrant.model_copy(update={"name": name}) for name in names)
        return tuple({(e.title, e.model_dump_json()): e for e in listed}.values())

    @property
    def model_names(self) -> tuple[str, ...]:
        """The models that take part, ``all`` spelled out as every law, those of plugins that broke included."""
        registered = plugins.load().laws
        listed: list[str] = []
        for name in self.models:
            first, *effects = name.split("+")
            laws = [*registered, *registered.lost] if first.strip() == ALL else [first.strip()]
            listed.extend("+".join([law, *(effect.strip() for effect in effects)]) for law in laws)
        return tuple(dict.fromkeys(listed))


def load_config(path: str | Path) -> Config:
    """Read a tournament from a YAML file and check every name in it.

    Raises:
        InputError: in one line, naming file, line and key, and the nearest right name.
    """
    return read_config(path)[0]


def read_config(path: str | Path) -> tuple[Config, Document]:
    """Read a tournament as :func:`load_config` does; return its file too, by which later errors name lines."""
    document = read_yaml(path)
    config = validate(document, Config)
    _check_once(config, document)
    _check_models(config, document)
    _check_estimators(config, document)
    _check_simulations(config, document)
    return config, document


def _check_once(config: Config, document: Document) -> None:
    """Refuse a file or a model that stands twice in its list: it is one all the same."""
    lists: list[tuple[tuple[str | int, ...], list[str]]] = [(("models",), config.models)]
    for index, dataset in enumerate(config.datasets):
        lists += [(("datasets", index, "files"), dataset.files or [])]
        lists += [(("datasets", index, "test_files"), dataset.test_files or [])]
    for place, names in lists:
        for index, name in enumerate(names):
            if name in names[:index]:
                raise document.error((*place, index), f"key '{place[-1]}': '{name}' stands twice; leave one out")


def _check_models(config: Config, document: Document) -> None:
    from fricmodels.model import Model

    for index, name in enumerate(config.models):
        law, *effects = (part.strip() for part in name.split("+"))
        try:
            if law == ALL:
                for effect in effects:
                    plugins.load().effects.entry(effect)
            else:
                Model.parse(name)
        except plugins.LeftOut:
            continue  # its rows say why, and the other models go on
        except InputError as error:
            raise document.error(("models", index), f"key 'models': {error}") from None


def _check_estimators(config: Config, document: Document) -> None:
    from pydantic import ValidationError

    from fricmodels.documents import first_problem

    registered = plugins.load().estimators
    for index, entrant in enumerate(config.estimators):
        place = ("estimators", index)
        if entrant.name == ALL:
            if entrant.settings:
                raise document.error((*place, "settings"), "key 'settings': goes with one estimator, not with 'all'")
            continue
        try:
            estimator = registered[entrant.name]
        except plugins.LeftOut:
            continue
        except InputError as error:
            raise document.error((*place, "name"), f"key 'estimators': {error}") from None
        try:
            estimator(entrant.settings)
        except ValidationError as error:
            path = (*place, "settings", *error.errors(include_url=False)[0]["loc"])
            problem = first_problem(error, estimator.Settings)
            raise document.error(path, f"settings of '{entrant.name}': {problem}") from None


def _check_simulations(config: Config, document: Document) -> None:
    from fricmodels.errors import suggestion
    from fricmodels.model import Model

    for index, dataset in enumerate(config.datasets):
        if dataset.simulate is None:
            continue
        place = ("datasets", index, "simulate")
        try:
            model = Model.parse(dataset.simulate.model)
        except InputError as error:
            raise document.error((*place, "model"), f"key 'model': {error}") from None
        keys = [parameter.key for parameter in model.parameters]
        given: Mapping[str, float] = dataset.simulate.parameters
        for key in given:
            if key not in keys:
                message = f"key '{key}' is no parameter of '{model.name}'{suggestion(key, keys)}"
                raise document.error((*place, "parameters", key), message)
        for key in keys:
            if key not in given:
                raise document.error((*place, "parameters"), f"key '{key}', a parameter of '{model.name}', is missing")
