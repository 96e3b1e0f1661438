"""Effect of what the paper leaves open on the curves of both models."""
