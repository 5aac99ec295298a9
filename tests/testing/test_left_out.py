"""Who asks for the exam of a plugin that is left out is told why it is."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.plugins.registry import Failure
from fricmodels.testing.sitting import named

REASON = "plugin 'mine' of my-package is left out: ImportError: no arctan"


@pytest.mark.parametrize("asked", ["tanh-law", "mine", "my-package", "lost-law", "no-such-name"])
def test_the_reason_is_told(asked: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The name of a law in a module that cannot be imported is not known: it may be this one."""
    concerns = ("law", "tanh-law") if asked == "tanh-law" else None
    lost = (("law", "lost-law"),) if asked == "lost-law" else ()
    failure = Failure("mine", "my-package", "ImportError: no arctan", concerns, lost)
    loaded = replace(plugins.load(), failures=(failure,))
    monkeypatch.setattr(plugins, "load", lambda: loaded)
    with pytest.raises(InputError) as told:
        named(asked)
    assert REASON in str(told.value)


def test_without_one_the_way_out_is_told() -> None:
    with pytest.raises(InputError, match="nothing is registered as 'no-such-name'; 'fricmodels list'"):
        named("no-such-name")
