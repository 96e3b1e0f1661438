"""How a path is followed: the model's interface, Newton's method, substeps, stability, arc length."""
