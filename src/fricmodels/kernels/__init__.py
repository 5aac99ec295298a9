"""From a symbolic expression to fast numbers: whole arrays at once, or one sample after the other."""

from __future__ import annotations

from fricmodels.kernels.arrays import ArrayFunction
from fricmodels.kernels.callback import Callback
from fricmodels.kernels.interpreted import Interpreted
from fricmodels.kernels.scan import Scan

__all__ = ["ArrayFunction", "Callback", "Interpreted", "Scan"]
