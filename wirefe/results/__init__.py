"""What is read off equilibria: forces, stresses, natural frequencies, files."""
