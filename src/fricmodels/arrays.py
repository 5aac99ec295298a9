"""The kinds of NumPy arrays that annotations name."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""Numbers."""

Mask: TypeAlias = NDArray[np.bool_]
"""Which samples."""

Index: TypeAlias = NDArray[np.int64]
"""Places of samples, or run numbers."""
