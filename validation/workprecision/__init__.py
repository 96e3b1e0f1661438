"""Run time against error of both models: what a given accuracy costs."""
