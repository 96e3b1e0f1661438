"""The path from equilibrium to equilibrium, its substeps, critical points and branches."""
