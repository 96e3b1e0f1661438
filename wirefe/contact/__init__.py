"""Contact of wires and of spheres, plates, and how far the wire runs into itself."""
