"""Runs both models on scenes, compares them, times them and reports."""
