"""An equilibrium at a fixed load."""
