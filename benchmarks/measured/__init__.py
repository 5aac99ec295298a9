"""Stories of real measurements: comparison, diagnosis and improvement, one data set a module."""
