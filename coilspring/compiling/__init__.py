"""How kernels are compiled, kept on disk, and given their data."""
