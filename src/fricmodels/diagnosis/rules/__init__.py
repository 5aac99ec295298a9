"""The decision constants of the diagnosis, by the question that they answer."""
