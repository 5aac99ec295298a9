"""Fits by sums that are made file by file and added up: for long recordings, and for many of them.

The rows of the weak form of a model that is linear in its parameters go into a least-squares fit through their products
alone. These are summed where the data lies (:func:`of_file`), kept as a small file, added (:func:`added`) and solved
(:func:`solved`). A :class:`Plan`, made once from one recording (:func:`plan_for`), lays down what the rows are, so that
sums of different files can be added.
"""

from __future__ import annotations

from fricmodels.sums.plan import Plan, plan_for
from fricmodels.sums.solve import solved
from fricmodels.sums.source import of_file, pilot
from fricmodels.sums.summed import Sums, added, load

__all__ = ["Plan", "Sums", "added", "load", "of_file", "pilot", "plan_for", "solved"]
