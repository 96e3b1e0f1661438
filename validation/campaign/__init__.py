"""Stability campaign: sampled scenes, verified by code that shares nothing with the solvers."""
