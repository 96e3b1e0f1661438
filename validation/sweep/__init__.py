"""Grids of scenes that differ in a few numbers, solved by a model, a row of a table each."""
