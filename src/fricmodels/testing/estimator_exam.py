"""The exam of estimators: known truths, honest intervals, divergence reported, the same answer twice."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from pydantic import ValidationError

from fricmodels import plugins
from fricmodels.arrays import Array
from fricmodels.dimension import Scales
from fricmodels.drive import Drive
from fricmodels.errors import EstimationError, FricmodelsError
from fricmodels.estimator import Estimator
from fricmodels.fit import Fit, Status
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.simulation import simulate
from fricmodels.testing.declared import Declared
from fricmodels.testing.exam import check_registered
from fricmodels.testing.faults import Fault, SkipTest

_LEAST_COVERAGE = 0.90
_SIDE = 1.96
_CERTAIN = 3.3
_NEAR, _WIDE = 0.125, 2.5
"""A share of an interval that tells those that are too wide, and how much too wide is still on the safe side."""
_TOO_LARGE, _TOO_SMALL = 2.0, 1.1
"""Factors by which standard errors may be too large, which is the safe side, or too small."""
_PIECES, _SHIFT = 8, 3
"""Runs into which a motion is cut, and samples by which each is shorter than the one before."""
_LOOSER = 2.0
"""Pieces of a motion, and one under another torque, may determine the parameters so much worse."""


class EstimatorExam(Declared):
    """The exam of an estimator::

        class TestMyEstimator(EstimatorExam):
            estimator = MyEstimator

    All but the estimator may also stand in its mapping ``exam``; then it counts for ``fricmodels check`` as well.

    Attributes:
        estimator: the class that sits the exam; settings: what it is made with.
        model, truth, inertia: the drive that is simulated, SI.
        amplitude, frequency: of the sinusoidal torque [N m, rad/s].
        tolerance: relative error allowed without noise.
        noise_percent, seeds: of the recordings on which coverage is counted.
    """

    of = "estimator"
    _may_say = (
        "settings",
        "model",
        "truth",
        "inertia",
        "amplitude",
        "frequency",
        "tolerance",
        "noise_percent",
        "seeds",
    )
    kind: ClassVar[str] = "estimator"
    estimator: ClassVar[type[Estimator]]
    settings: ClassVar[Mapping[str, Any]] = {}
    model: ClassVar[str] = "coulomb-viscous"
    truth: ClassVar[Mapping[str, float]] = {"K_v": 1.0e-4, "K_c": 1.0e-2}
    inertia: ClassVar[float] = 4.87e-6
    amplitude: ClassVar[float] = 0.03
    frequency: ClassVar[float] = 39.54
    tolerance: ClassVar[float] = 0.02
    noise_percent: ClassVar[float] = 2.0
    seeds: ClassVar[int] = 40

    def recording(self, noise_percent: float = 0.0, seed: int = 0) -> Recording:
        """Return a recording of the drive of the exam; override it for another motion."""
        time = self._time()
        torque = self.amplitude * np.sin(self.frequency * time)
        return simulate(self.drive, self.truth, time, torque, substeps=5, noise=noise_percent, seed=seed)

    def _time(self) -> Array:
        return np.asarray(2 * np.pi / self.frequency / 200 * np.arange(2000))

    @property
    def drive(self) -> Drive:
        """The drive of the exam."""
        if (self.model, self.inertia) not in _drives:
            _drives[self.model, self.inertia] = Drive(Model.parse(self.model), self.inertia)
        return _drives[self.model, self.inertia]

    def fit(self, recording: Recording, seed: int = 0) -> Fit:
        """Fit the drive of the exam."""
        return self.estimator(self.settings).fit(self.drive, recording, seed=seed)

    def test_declaration(self) -> None:
        """Name, summary, and settings that refuse unknown keys."""
        if not getattr(self.estimator, "name", "") or not self.estimator.summary:
            raise Fault("name or summary is empty; both are printed in lists and leaderboards")
        try:
            self.estimator({"there_is_no_such_setting": 1})
        except ValidationError:
            return
        raise Fault("an unknown setting is taken without a word; derive Settings from EstimatorSettings")

    def test_registered(self) -> None:
        """Found by the plugin manager."""
        check_registered(self.kind, self.estimator)

    def test_fit_is_complete(self) -> None:
        """Every parameter and the inertia, a covariance of their size, names as given."""
        fit = self.fit(self.recording(self.noise_percent))
        keys = {self.drive.inertia_key, *self.drive.keys}
        if set(fit.parameters) != keys:
            wrong = sorted(keys ^ set(fit.parameters))[0]
            raise Fault(f"fit.parameters lacks or invents '{wrong}'; it holds {', '.join(sorted(keys))}")
        if fit.covariance.shape != (len(fit.estimated), len(fit.estimated)) or set(fit.estimated) != set(
            self.drive.keys
        ):
            raise Fault("fit.covariance must be square, rows and columns as in fit.estimated, which is drive.keys")
        if not np.allclose(fit.covariance, fit.covariance.T, rtol=1e-6, atol=0.0, equal_nan=True):
            raise Fault("fit.covariance is not symmetric; return (P + P.T) / 2")
        if not all(error > 0 for error in fit.standard_errors.values()):
            raise Fault("a standard error is not positive on noisy data; the diagonal of fit.covariance is wrong")
        if not all(fit.no_interval.values()):
            raise Fault("a parameter has no interval and no reason for it; fill fit.no_interval")
        names = (fit.model, fit.estimator)
        if names != (self.drive.model.name, self.estimator.name):
            raise Fault(f"fit.model and fit.estimator are {names}; give drive.model.name and self.name")

    def test_known_truth(self) -> None:
        """Without noise the true parameters come out."""
        fit = self.fit(self.recording())
        if fit.status is not Status.OK:
            raise Fault(f"without noise the fit ends as '{fit.status}': {fit.message}")
        for key, true in self.truth.items():
            error = fit.parameters[key] / true - 1
            if not abs(error) <= self.tolerance:
                raise Fault(
                    f"{key} = {fit.parameters[key]:.5g} for a true {true:.5g} ({100 * error:+.1f} %) without noise; "
                    "look at samples at rest, at the torque between samples, and at normalisation"
                )

    def test_sizes_do_not_matter(self) -> None:
        """A drive a thousand times as strong, ten times as slow, has the same relative answer."""
        scales = Scales(force=1e-3, displacement=1.0, time=0.1)
        small = self.recording(self.noise_percent)
        drive = self.drive.scaled(scales)
        first = self.fit(small)
        second = self.estimator(self.settings).fit(drive, small.scaled(scales), seed=0)
        back = dict(zip(drive.keys, drive.restore([second.parameters[key] for key in drive.keys], scales), strict=True))
        for key, value in back.items():
            if not abs(value - first.parameters[key]) <= 0.1 * first.standard_errors.get(key, 0.0) + 1e-3 * abs(value):
                raise Fault(
                    f"{key} changes from {first.parameters[key]:.5g} to {value:.5g} with the units of the recording; a "
                    "number of fixed size decides: scale the problem with Scales before solving it"
                )

    def test_recording_is_not_changed(self) -> None:
        """The arrays of the recording are as before."""
        recording = self.recording(self.noise_percent)
        before = {name: values.copy() for name, values in recording.channels.items()}
        self.fit(recording)
        for name, values in before.items():
            if not np.array_equal(recording.channels[name], values):
                raise Fault(f"the fit changes the channel '{name}' of the recording; work on a copy")

    def test_deterministic(self) -> None:
        """The same seed, the same answer."""
        recording = self.recording(self.noise_percent, seed=1)
        first, second = (self.fit(recording, seed=5) for _ in range(2))
        if dict(first.parameters) != dict(second.parameters):
            raise Fault("two fits with the same seed differ; draw from numpy.random.default_rng(seed) alone")

    def test_coverage(self) -> None:
        """Intervals of nominally 95 % hold the truth in 90 of 100 cases; standard errors are as large as errors are."""
        distances: list[float] = []
        for seed in range(self.seeds):
            fit = self.fit(self.recording(self.noise_percent, seed))
            distances += [
                abs(fit.parameters[key] - self.truth[key]) / error for key, error in fit.standard_errors.items()
            ]
        if not distances:
            return
        for side, least, most in ((_SIDE, _LEAST_COVERAGE, 1.0), (_NEAR * _SIDE, 0.0, _most_near())):
            share = float(np.mean(np.less_equal(distances, side)))
            if not _likely(least, self.seeds)[0] <= share <= _likely(most, self.seeds)[1]:
                too, cause = ("small", "1/2") if share < least else ("large", "n")
                right = 100 * (2 * _below(side) - 1)
                raise Fault(
                    f"intervals of ± {side:.2g} standard errors hold the truth in {100 * share:.0f} % of {self.seeds} "
                    f"recordings, where {right:.0f} % are right: the standard errors are too {too}; look for a factor "
                    f"such as {cause} in fit.covariance, a variance for a standard deviation, autocorrelated residuals "
                    "and the noise of the velocity"
                )
        size = math.sqrt(float(np.mean(np.square(distances))))
        least_size, most_size = _likely_sizes(self.seeds)
        if not least_size <= size <= most_size:
            too, cause = ("small", "a bias that they do not include") if size > 1 else ("large", "what they add up")
            raise Fault(
                f"over {self.seeds} recordings the errors are {size:.2g} standard errors (root mean square): the "
                f"standard errors are too {too}; look for {cause}, or give no interval and the reason (no_interval)"
            )

    def test_load_torque(self) -> None:
        """A load torque that was recorded is taken off, or refused."""
        time = self._time()
        load = 0.2 * self.amplitude * np.sin(self.frequency * time - 1.2)  # along the motion, as friction would be
        torque = self.amplitude * np.sin(self.frequency * time) + load
        recording = simulate(self.drive, self.truth, time, torque, load_torque=load, substeps=5)
        self._finds_truth(
            recording,
            "with a recorded load torque",
            "the equation of motion is J dω/dt = τ_m − τ_L − τ_F: take recording.load_torque off the torque",
        )

    def test_runs(self) -> None:
        """Where one run ends and the next begins nothing is derived or carried over, or several runs are refused."""
        whole = self.recording()
        length = len(whole) // _PIECES
        order = np.random.default_rng(14).permutation(_PIECES)
        rows = np.concatenate(
            [np.arange(piece * length, (piece + 1) * length - _SHIFT * int(piece)) for piece in order]
        )
        sizes = [length - _SHIFT * int(piece) for piece in order]
        run = np.repeat(np.arange(_PIECES), sizes)
        channels = {name: values[rows] for name, values in whole.channels.items()}
        recording = Recording(whole.name, whole.motion, channels, run.astype(np.int64), provenance=whole.provenance)
        self._finds_truth(
            recording,
            f"with {_PIECES} runs",
            "differences, filters and integrals begin anew where recording.run changes; recording.runs() gives each",
        )

    def _finds_truth(self, recording: Recording, how: str, advice: str) -> None:
        try:
            fit = self.fit(recording)
        except EstimationError:
            return
        if fit.status is not Status.OK:
            raise Fault(f"{how} the fit ends as '{fit.status}': {fit.message}; {advice}")
        for key, true in self.truth.items():
            error = fit.parameters[key] / true - 1
            if not abs(error) <= _LOOSER * self.tolerance:
                raise Fault(
                    f"{how} {key} = {fit.parameters[key]:.5g} for a true {true:.5g} ({100 * error:+.1f} %), without "
                    f"noise; {advice}"
                )

    def test_failure_is_reported(self) -> None:
        """Recordings that cannot be fitted end in an error or a status, not in numbers."""
        for what, recording in self._hopeless():
            try:
                fit = self.fit(recording)
            except EstimationError:
                continue
            except FricmodelsError as error:
                raise Fault(f"{what}: raises {type(error).__name__}; raise EstimationError with one line") from None
            except Exception as error:
                raise Fault(f"{what}: raises {type(error).__name__}: {error}; raise EstimationError instead") from None
            finite = all(math.isfinite(value) for value in fit.parameters.values())
            if fit.status is Status.OK and not finite:
                raise Fault(f"{what}: the status is 'ok' with parameters that are not finite; report 'diverged'")
            if fit.status is Status.OK and not fit.not_identified and "velocity" not in what:
                raise Fault(
                    f"{what}: the status is 'ok' and nothing is said; fill not_identified or raise EstimationError"
                )
            if fit.status is not Status.OK and not fit.message:
                raise Fault(f"{what}: the status is '{fit.status}' without a message; say why")

    def _hopeless(self) -> Iterator[tuple[str, Recording]]:
        good = self.recording()
        still = np.zeros(len(good))
        yield "a motor that stands still", good.with_channels(derived=False, velocity=still)
        yield "a torque that is zero", good.with_channels(derived=False, torque=still)
        huge = good.velocity.copy()
        huge[len(huge) // 2] = 1e150
        yield "a velocity of 1e150", good.with_channels(derived=False, velocity=huge)
        yield "three samples", good.select(np.arange(3))

    def test_terms_with_memory(self) -> None:
        """They are fitted, or refused in one line."""
        effects = plugins.load().effects
        if "presliding" not in effects:
            raise SkipTest("the effect 'presliding' is not registered")
        drive = Drive(Model.parse(f"{self.model}+presliding"), self.inertia)
        try:
            fit = self.estimator(self.settings).fit(drive, self.recording(self.noise_percent), seed=0)
        except EstimationError as error:
            if self.estimator.carries_states:
                raise Fault(f"carries_states = True, but a term with memory is refused: {error}") from None
            return
        if not self.estimator.carries_states:
            raise Fault("carries_states = False, but a term with memory is fitted; raise EstimationError, or claim it")
        if fit.status is Status.OK and not all(math.isfinite(value) for value in fit.parameters.values()):
            raise Fault("with a term with memory the parameters are not finite and the status is 'ok'")


_drives: dict[tuple[str, float], Drive] = {}


def _likely(share: float, recordings: int) -> tuple[float, float]:
    """Return between what a share can lie that is counted on so many recordings, one parameter each."""
    spread = _CERTAIN * math.sqrt(share * (1 - share) / recordings)
    return share - spread, share + spread


def _likely_sizes(recordings: int) -> tuple[float, float]:
    """Return between what errors in standard errors lie (root mean square), counted on so many recordings.

    By chi-square; standard errors may be too small by a tenth, and too large by a factor.
    """
    from scipy.special import chdtri

    tail = 1.0 - _below(_CERTAIN)
    least, most = (math.sqrt(float(chdtri(recordings, p)) / recordings) for p in (1.0 - tail, tail))
    return least / _TOO_LARGE, most * _TOO_SMALL


def _below(deviations: float) -> float:
    """Return the share of a normal distribution below so many standard deviations."""
    return 0.5 * (1 + math.erf(deviations / math.sqrt(2)))


def _most_near() -> float:
    """Return how often truths lie that near where intervals are as wide as is allowed."""
    return 2 * _below(_NEAR * _WIDE * _SIDE) - 1
