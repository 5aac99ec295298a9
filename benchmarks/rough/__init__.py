"""Parts of the challenge on rough drives; see ``benchmarks/rough_drives.py``. Shares no physics with ``fricmodels``."""
