"""Ways to spoil a good recording, and where good recordings come from, for :mod:`sabotage`."""
