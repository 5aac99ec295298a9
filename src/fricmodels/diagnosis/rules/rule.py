"""A decision constant with its unit, the rule that uses it, and its evidence; a set of such constants."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any, Self


def rule(value: Any, unit: str, text: str, evidence: str, off: Any = None) -> Any:
    """Declare a constant: its unit, the rule that uses it, why it has this value, and the value that ends the rule."""
    return field(default=value, metadata={"unit": unit, "rule": text, "evidence": evidence, "off": off})


@dataclass(frozen=True)
class Rules:
    """A set of decision constants, each declared by :func:`rule`."""

    def without(self, name: str) -> Self:
        """Return the set with one rule switched off, by the name of its constant.

        Raises:
            ValueError: when there is no such constant, or it cannot be switched off.
        """
        off = {entry.name: entry.metadata["off"] for entry in fields(self) if entry.metadata["off"] is not None}
        if name not in off:
            raise ValueError(f"no rule '{name}' can be switched off; known: {', '.join(off)}")
        return replace(self, **{name: off[name]})

    @classmethod
    def table(cls) -> list[tuple[str, str, str, str, str]]:
        """Return name, value, unit, rule and evidence of every constant, in order."""
        told = [[entry.metadata[key] for key in ("unit", "rule", "evidence")] for entry in fields(cls)]
        return [(entry.name, _shown(entry.default), *rest) for entry, rest in zip(fields(cls), told, strict=True)]


def _shown(value: Any) -> str:
    return ", ".join(f"{part:.3g}" for part in value) if isinstance(value, tuple) else f"{value:.3g}"
