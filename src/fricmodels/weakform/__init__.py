"""The equation of motion in weak form: one engine for estimators and diagnosis."""
