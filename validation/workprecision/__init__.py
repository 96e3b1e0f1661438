"""Run time against error of both models: what a given accuracy costs."""

EQUAL_ERROR = "Time at equal error"  # section of its page, which the report on the paper shows, too
