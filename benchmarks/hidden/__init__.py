"""Parts of the hidden-effect challenge; see ``benchmarks/hidden_effects.py``."""
