"""Measured load curves: fits of the equivalent beam, and models beside them."""
