"""Two-node beam elements: rotations, energy, elements at rest, motion along a step."""
