r"""Files whose noise is unlike, as that of different loggers is.

One noise for all of them would be that of none: rows of the noisy one would decide as much as those of the quiet one,
and what its noise leaves would be told as what no model explains.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from fricmodels.arrays import Array, Index
from fricmodels.recording import RUN, Recording
from fricmodels.signals.noise_colour import Noise

_UNLIKE = 2.0
"""Ratio ρ of the largest standard deviation to the least from which noises are unlike. Of as much of both, rows that
count alike have errors that are larger by :math:`(1 + \rho^2) / (2 \rho)`, a quarter; estimates of one noise differ by
less, as motion that is taken for noise makes them differ."""
_FEW = 500
"""Samples below which a file tells no noise of its own."""


def groups(recording: Recording) -> list[Index]:
    """Return the samples of each file that are enough to tell a noise; runs of one file are of one logger."""
    file_of_run = recording.provenance.get("file_of_run", {})
    if len(set(file_of_run.values())) < 2:
        return []
    numbers, run = np.unique(recording.signal(RUN), return_inverse=True)
    files = [file_of_run.get(number, number) for number in numbers.astype(int).tolist()]
    known = {name: number for number, name in enumerate(dict.fromkeys(files))}
    of = np.array([known[name] for name in files])[run]
    every = [np.flatnonzero(of == number) for number in range(len(known))]
    return [index for index in every if len(index) >= _FEW]


@dataclass(frozen=True)
class NoiseOfFiles(Noise):
    """Noise that is another one in some files; its white part has the size of all.

    Attributes:
        of_files: the noises.
        which: of these the one that each sample has, shape (N,).
    """

    of_files: tuple[Noise, ...] = field(default=(), compare=False)
    which: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64), compare=False)

    @property
    def is_white(self) -> bool:
        """No: not as a whole."""
        return False

    def covariance(self, count: int) -> Array:
        """Return its mean autocovariance over all samples at lags of 0 to count − 1 samples."""
        if self.filtered is not None:
            return super().covariance(count)
        shares = np.bincount(self.which, minlength=len(self.of_files)) / len(self.which)
        return np.asarray(
            sum(s * own.covariance(count) for s, own in zip(shares, self.of_files, strict=True) if s > 0.0)
        )

    def like(self, count: int, rng: np.random.Generator) -> Array:
        """Return noise as this one, shape (count,), as many as there are samples."""
        if self.filtered is not None:
            return super().like(count, rng)
        drawn = np.zeros(count)
        for number, own in enumerate(self.of_files):
            drawn[self.which == number] = own.like(int(np.sum(self.which == number)), rng)
        return drawn

    def at(self, index: Index) -> Noise:
        """Return the noise of some of the samples: if all have the same one, that."""
        place, which = np.zeros(len(self.which), dtype=np.int64), self.which[index]
        for number in range(len(self.of_files)):
            place[self.which == number] = np.arange(np.sum(self.which == number))
        own = [noise.at(place[index][which == number]) for number, noise in enumerate(self.of_files)]
        if len(which) and np.all(which == which[0]):
            one: Noise = replace(own[which[0]], filtered=self.filtered)
            return one
        return replace(self, of_files=tuple(own), which=which)


def with_own_noises(recording: Recording, of_all: Noise, noise_of: Callable[[Recording], Noise]) -> Noise:
    """Return the noise of a channel, of each file its own where they are unlike.

    Args:
        recording: of one file or several.
        of_all: its noise, found of all together, which files of few samples have.
        noise_of: finds that of the runs of one file.
    """
    every = groups(recording)
    if len(every) < 2:
        return of_all
    own = [noise_of(replace(recording.select(index), origin=None)) for index in every]
    sizes = [noise.deviation for noise in own]
    if max(sizes) <= _UNLIKE * min(sizes) or min(sizes) <= 0.0:
        return of_all
    which = np.zeros(len(recording), dtype=np.int64)
    for number, index in enumerate(every, start=1):
        which[index] = number
    others = replace(of_all, course=None, error=None, scale=None, white=of_all.deviation, lasting=0.0, difference=0.0)
    found = NoiseOfFiles(0.0, of_files=(others, *own), which=which)
    return replace(found, white=math.sqrt(found.covariance(1)[0]))
