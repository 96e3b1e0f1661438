"""Looks of the figures: a journal's columns, colours that also differ in grey and to the colour-blind."""

import tomllib
from pathlib import Path
from typing import Any

Look = dict[str, Any]  # keywords of a line or a patch

SINGLE, DOUBLE = 3.35, 6.69  # column widths, in: 85 and 170 mm
# one colour a model in every figure, as in the paper, also apart in grey: the beam blue, the wire model red
BLUE, RED, GREY = "#4a8bc9", "#a8320e", "#8c8c8c"
NAVY, LIGHT_RED = "#173a63", "#e07b52"  # second lines of the beam and of the wire model

RC: dict[Any, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
# Both models mostly coincide: the beam is a wide pale line, the wire model a thin dashed one on top.
BEAM_LINE: Look = {"color": BLUE, "linewidth": 2.6, "solid_capstyle": "butt"}
WIRE_LINE: Look = {"color": RED, "linewidth": 1.1, "linestyle": (0, (4, 2))}
BEAM_LABEL, WIRE_LABEL = "equivalent beam (proposed model)", "wire model (FE)"
TIP_LABELS = ("UX (mm)", "UY (mm)", "ROTZ (rad)")  # the components of a tip, on axes and in tables
REST_CIRCLE: Look = {"facecolor": "none", "edgecolor": "#b5b5b5", "linewidth": 0.5}
BEAM_CIRCLE: Look = {"facecolor": f"{BLUE}33", "edgecolor": BLUE, "linewidth": 1.8}
WIRE_CIRCLE: Look = {"facecolor": "none", "edgecolor": RED, "linewidth": 0.9, "linestyle": (0, (3, 2))}
