"""Errors suggest the way out."""

from __future__ import annotations

from fricmodels.errors import EstimationError, FricmodelsError, InputError, suggestion


def test_the_nearest_known_name_is_suggested() -> None:
    assert suggestion("coging", ["cogging", "gravity"]) == "; did you mean 'cogging'?"


def test_where_nothing_is_near_all_are_listed_in_order() -> None:
    assert suggestion("xyz", ["gravity", "cogging"]) == "; known: cogging, gravity"
    assert suggestion("xyz", []) == ""


def test_exit_codes_tell_bad_input_from_failed_work() -> None:
    assert (FricmodelsError.exit_code, EstimationError.exit_code, InputError.exit_code) == (1, 1, 2)
    assert issubclass(InputError, FricmodelsError)
