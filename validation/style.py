"""Looks of the figures: a journal's columns, colours that also differ in grey and to the colour-blind."""

from __future__ import annotations

SINGLE, DOUBLE = 3.5, 7.0  # column widths, in
BLUE, RED, GREY = "#2457a6", "#e8562a", "#8c8c8c"  # as the paper: proposed model blue, FE red

RC = {
    "figure.dpi": 200,
    "savefig.dpi": 200,
    "font.family": "sans-serif",
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.0,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.2,
    "axes.axisbelow": True,
}
# Both models mostly coincide: the beam is a wide light line, the wire model a thin dashed one on top.
BEAM_LINE = {"color": BLUE, "linewidth": 2.2, "alpha": 0.75, "solid_capstyle": "butt"}
WIRE_LINE = {"color": RED, "linewidth": 1.1, "linestyle": (0, (4, 2))}
BEAM_LABEL, WIRE_LABEL = "equivalent beam (proposed model)", "wire model (FE)"
