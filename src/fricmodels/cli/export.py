"""``fricmodels export``: a fitted model for another program."""


def command() -> None:
    """x."""
