"""Every constant that decides what a diagnosis says: its value, its unit, the rule that uses it, and its evidence.

The functions of the diagnosis take a :class:`Policy` along; ``replace(POLICY, …)`` changes a rule or switches it off,
and a benchmark shows what it is worth. Constants of numerical methods decide nothing and stay where they are used.
"""

from __future__ import annotations

from dataclasses import dataclass

from fricmodels.diagnosis.rules.channels import ChannelRules
from fricmodels.diagnosis.rules.ladder import LadderRules
from fricmodels.diagnosis.rules.naming import NamingRules
from fricmodels.diagnosis.rules.passing import PassingRules
from fricmodels.diagnosis.rules.refits import RefitRules


@dataclass(frozen=True)
class Policy(LadderRules, RefitRules, ChannelRules, NamingRules, PassingRules):
    """The decision constants of the diagnosis; :meth:`table` gives their units, rules and evidence.

    *Residual* means what a model leaves in the weak form; *test error* the RMS torque error on data that took no part
    in the fit. Shares of a residual are of its RMS, unless they are said to be squared. Fields come in the order of
    the questions: what passes, what is named, what channels say to it, what a refit says, what the ladder does.
    """


POLICY = Policy()
"""The policy of every command."""
