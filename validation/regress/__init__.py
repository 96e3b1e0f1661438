"""What both models find now against baselines."""
