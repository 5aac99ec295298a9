"""The built-in readers, one format a file."""
