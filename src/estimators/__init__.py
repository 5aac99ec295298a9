"""The built-in estimators, one a file."""
