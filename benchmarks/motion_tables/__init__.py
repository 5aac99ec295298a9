"""The tables of docs/tables.md, one module a machine."""
