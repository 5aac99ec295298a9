"""Numbers of the command line that are quantities: what is no number is told with the unit that it should have."""

from __future__ import annotations


def inertia(text: str) -> float:
    """Return an inertia [kg m²], or a mass [kg] of a linear axis.

    Raises:
        typer.BadParameter: for what is no number; with the number, where it is one with a unit or a decimal comma.
    """
    import typer

    try:
        return float(text)
    except ValueError:
        pass
    number = _meant(text.strip())
    way_out = f"give --inertia {number}" if number else "give it as in --inertia 0.02"
    raise typer.BadParameter(
        f"'{text[:60]}' is no number; the inertia is one of kg m² (of kg, the mass of a linear axis): {way_out}"
    )


def _meant(text: str) -> str:
    """Return the number that a text with a unit or with a decimal comma stands for; empty where that is not known."""
    from fricmodels.errors import InputError
    from fricmodels.readers import units

    plain = text.replace(",", ".") if text.count(",") == 1 and "." not in text else text
    try:
        return f"{float(plain):.10g}"
    except ValueError:
        pass
    try:
        conversion, unit = units.further(plain)
    except InputError:
        return ""
    return f"{conversion.factor:.10g}" if unit in ("kg m^2", "kg") else ""
