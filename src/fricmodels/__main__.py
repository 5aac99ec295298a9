"""``python -m fricmodels``: the command line."""

from __future__ import annotations

from fricmodels.cli import main

if __name__ == "__main__":
    main()
