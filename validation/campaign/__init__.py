"""Stability campaign: sampled scenes, judged by code that shares nothing with the solvers."""
