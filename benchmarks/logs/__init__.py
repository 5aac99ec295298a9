"""Drives as engineers move and log them; the simulator shares nothing with the rig, nor with the rough drives."""
