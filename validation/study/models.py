"""Names of the models and of the laws, for what is imported before either of them is."""

from coilspring.pathfile import MODELS

BEAM, WIRE = MODELS
PAPER_LAW, HELIX_LAW = LAWS = ("haringx", "helix")  # built into the equivalent beam; cheap to dear
