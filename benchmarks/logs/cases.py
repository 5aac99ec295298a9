"""All cases, by the number from which their random numbers come."""

from __future__ import annotations

from logs.case import Case
from logs.clean import CLEAN
from logs.several import SEVERAL, UNLISTED
from logs.single import SINGLE

CASES: tuple[Case, ...] = tuple(sorted((*CLEAN, *SINGLE, *SEVERAL, *UNLISTED), key=lambda case: case.number))
