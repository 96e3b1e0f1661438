"""The wire as a solid body: its section by finite elements, coils as hexahedra, and what both change."""
