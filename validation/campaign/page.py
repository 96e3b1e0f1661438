"""Page and picture of a campaign: ``stability.md`` and ``stability.png``."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from validation.campaign.scenes import CORNERS, MODELS
from validation.campaign.table import DISPLACEMENT, FORCE, Row, version
from validation.campaign.verdict import (
    APART,
    CLASSES,
    CONFIRMED,
    ENDED,
    REFUSED,
    RIGHT,
    THROUGH,
    UNEXPLAINED,
)
from validation.study.document import Block, Bullets, Heading, Picture, Table, Text, to_markdown
from validation.study.machine import versions
from validation.study.output import write_facts, write_files, write_text
from validation.study.plots import drawn
from validation.study.style import DOUBLE, RC

GIVEN = (FORCE, DISPLACEMENT)
TITLES = {"b": "equivalent beam", "w": "wire model"}
MEANING = {
    RIGHT: "to the full load or displacement: stable equilibria, on the branch of other runs",
    CONFIRMED: "up to a limit point or bifurcation that the judge finds at the same load or displacement",
    THROUGH: "up to where coils pass through each other: the wire, or the circles, overlap by 0.1 diameters "
    "more than the deepest pair; the judge finds as much by points of its own",
    ENDED: "friction, up to where Coulomb's law goes on but the iteration on renewed bounds does not, or to "
    "where a pair that was held opens and what it held is lost; states before are judged",
    APART: "friction or no sliding: balanced, but with other substeps apart by more than 2 %, from the first "
    "touch on; a pair remembers where it was when its substep ended",
    REFUSED: "bad input, refused in one sentence",
    UNEXPLAINED: "everything else",
}
NUMBERS = {
    "residual": "way to the equilibrium over that from rest (beam); force left over the load (wire)",
    "branch": "difference from the run in one step and from the fine run over the largest displacement",
    "bracket": "width of the solver's bracket of a critical time, relative",
    "critical_shift": "change of a critical time by other steps or an invariance, relative",
    "confirmed": "distance of the judge's sign change, fold, highest load or vanishing stiffness from the "
    "critical time, relative",
    "passed": "how far arc length stays stable beyond the critical time, relative",
    "overlap": "where coils pass through each other: the overlap found less that claimed, in wire diameters",
    "place": "prescribed displacement: distance of the top from where it is prescribed, relative",
    "reaction": "reported reaction to a prescribed displacement against the judge's own, relative (beam; the "
    "wire's is in `residual`)",
    "friction": "friction beyond its bound, over the largest bound",
}
KINDS = {
    "mirror": "mirror image",
    "binary": "units by powers of two",
    "units": "units by 1000",
    "perturbed": "input changed by 1e-12",
}
CHANGES = (
    "Rounding may change the answer by 1e-10 over the least stiffness (in units of that at rest), units "
    "by 1e-6, a change of the input by 1e-12 by 1e-8; and positions are no finer than 4 roundings "
    "of the spring's height. With friction or no sliding the answer depends on the substeps, which may "
    "change it by 2 %."
)
SAMPLED = (
    "In a fifth of the scenes UY of the top is prescribed, 4 to 104 % of the way to solid, solid corners to "
    "120 %; in the others a force acts. Under a prescribed displacement the judge frees all but that motion: "
    "what is left must balance, the force there must be the reported reaction, and critical points are those "
    "of the constrained spring; a wire's with friction or no sliding are judged by its other runs alone."
)
STEPS = (
    "Every scene is solved in three numbers of steps: one, a random one, and the multiple of that next to "
    "200 (twice at least). All must have one outcome; frictionless ones the same end time within 1e-4, and "
    "the same tips within 1e-6 of the largest displacement, or 1e-8 over the root of the least stiffness; "
    "with friction or no sliding both within 2 %."
)
CAPTION = (
    "Outcome over penalty and steps, slenderness and load. The darker a cell, the more of its scenes end at "
    "a limit point or bifurcation before full load, each of which the judge finds at the same load by other "
    "means. Crosses: unexplained."
)
MAPS = (("penalty", "steps"), ("slenderness", "load"))
LABELS = {
    "penalty": "penalty K (N/mm$^k$)",
    "steps": "requested steps",
    "slenderness": "height over mean diameter",
    "load": "share of the way to solid, or load over that\nof solid height or a deflection of 1.2 heights",
}
LOGARITHMIC = ("penalty", "steps", "slenderness")
EDGES = {
    "penalty": np.geomspace(1e2, 1e10, 17),
    "steps": np.array([1, 2, 3, 5, 8, 13, 22, 37, 63, 112, 201]),
    "slenderness": np.geomspace(0.2, 7.0, 15),
    "load": np.linspace(0.0, 1.5, 16),
}
TICKS = {"slenderness": (0.2, 0.5, 1, 2, 5), "steps": (1, 3, 10, 30, 100)}
COARSER = {"b": 1, "w": 2}  # cells taken together
OTHER_UNITS = ("tiny", "huge")  # whose penalties say nothing beside the others'
FEWEST = 3  # scenes of a cell that is coloured


def write_page(rows: list[Row], out: Path, seed: int) -> None:
    """Write page and picture of the rows."""
    write_files(drawn(outcome_figure(rows), "stability"), out)
    write_text(out / "stability.md", page(rows, seed))
    counts = {letter: dict(zip(CLASSES, _counts(rows, letter)[1:], strict=True)) for letter in MODELS}
    names = {"b": "beam", "w": "wire"}
    write_facts({f"{names[x]}.{name}": int(n) for x, row in counts.items() for name, n in row.items()}, out)


def page(rows: list[Row], seed: int) -> str:
    """The page, Markdown."""
    used = ", ".join(f"{name} {number}" for name, number in versions().items() if number)
    listed = [row for row in rows if row["class"] in (UNEXPLAINED, ENDED, APART, REFUSED)]
    blocks = (
        Heading(1, "Stability campaign"),
        Text(f"Seed {seed}, sources {version()}, {used}."),
        Text(f"Any case again: `coilcheck stability --case ID --seed {seed}`."),
        Heading(2, "What became of the scenes"),
        Table(("model", *CLASSES), tuple(_counts(rows, letter) for letter in MODELS)),
        Bullets(tuple(f"*{name}*: {MEANING[name]}" for name in CLASSES)),
        Heading(2, "Forces and prescribed displacements"),
        Text(SAMPLED),
        Table(("given", *CLASSES), tuple(_given(rows, letter, by) for letter in MODELS for by in GIVEN)),
        Heading(2, "Numbers of steps"),
        Text(STEPS),
        Text(_stepped(rows)),
        Picture("stability.png", CAPTION),
        Heading(2, "Corners"),
        Table(("corner", *CLASSES), tuple(_corner(rows, name) for name in ("", *CORNERS))),
        Heading(2, "Largest of what the judge measured, completed, critical and interpenetration alone"),
        Table(("number", *TITLES.values(), "meaning"), tuple(_largest(rows, name) for name in NUMBERS)),
        Heading(2, "Invariances: largest change of the answer over the largest displacement"),
        Table(("changed", "cases", *TITLES.values()), tuple(_invariance(rows, kind) for kind in KINDS)),
        Text(CHANGES),
        Heading(2, "Unexplained, ended, apart and refused"),
        _listed(listed),
    )
    return to_markdown(blocks)


def _counts(rows: list[Row], letter: str) -> tuple[str, ...]:
    counts = Counter(row["class"] for row in rows if row["id"][0] == letter)
    return TITLES[letter], *(str(counts[name]) for name in CLASSES)


def _given(rows: list[Row], letter: str, by: str) -> tuple[str, ...]:
    mine = [row for row in rows if row["by"] == by]
    return f"{TITLES[letter]}, {by}", *_counts(mine, letter)[1:]


def _stepped(rows: list[Row]) -> str:
    """How many scenes have a critical point that a run stepped over."""
    compared = [row for row in rows if row["stepped"]]
    over = [row["id"] for row in compared if float(row["stepped"]) > 0.0]
    named = f": {', '.join(over)}" if over else ""
    return f"A run stepped over a critical point of another in {len(over)} of {len(compared)} scenes{named}."


def _corner(rows: list[Row], corner: str) -> tuple[str, ...]:
    counts = Counter(row["class"] for row in rows if row["corner"] == corner)
    return corner or "none", *(str(counts[name]) for name in CLASSES)


def _largest(rows: list[Row], name: str) -> tuple[str, ...]:
    return name, *(_most(rows, letter, name) for letter in MODELS), NUMBERS[name]


def _most(rows: list[Row], letter: str, name: str, kind: str = "") -> str:
    told = (RIGHT, CONFIRMED, THROUGH)
    explained = [row for row in rows if row["id"][0] == letter and row["class"] in told]
    found = [float(row[name]) for row in explained if row[name] and (not kind or row["kind"] == kind)]
    return f"{max(found):.1e}" if found else "-"


def _invariance(rows: list[Row], kind: str) -> tuple[str, ...]:
    count = sum(row["kind"] == kind for row in rows)
    return KINDS[kind], str(count), *(_most(rows, letter, "invariance", kind) for letter in MODELS)


def _listed(rows: list[Row]) -> Block:
    if not rows:
        return Text("None.")
    lines = ((row["id"], row["corner"], row["outcome"], row["reason"] or row["message"]) for row in rows)
    return Table(("case", "corner", "outcome", "reason"), tuple(lines))


def outcome_figure(rows: list[Row]) -> Figure:
    """Share of scenes that end at a critical point, over the numerics and over the physics."""
    letters = [letter for letter in MODELS if any(row["id"][0] == letter for row in rows)] or ["b"]
    looks: Any = RC
    with matplotlib.rc_context(looks):
        figure = Figure(figsize=(DOUBLE, 0.5 + 2.5 * len(letters)), layout="constrained")
        plots = figure.subplots(len(letters), 2, squeeze=False)
        for i, letter in enumerate(letters):
            for j, names in enumerate(MAPS):
                mine = [row for row in rows if row["id"][0] == letter]
                if "penalty" in names:
                    mine = [row for row in mine if row["corner"] not in OTHER_UNITS]
                mesh = _map(plots[i, j], mine, names, COARSER[letter])
                plots[i, j].set_title(f"({'abcd'[2 * i + j]}) {TITLES[letter]}")
        bar = figure.colorbar(mesh, ax=plots, shrink=0.7, aspect=30)
        bar.set_label("share of scenes that end at\na confirmed critical point (%)")
        bar.outline.set_linewidth(0.5)
        handles, labels = plots[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure


def _map(axes: Axes, rows: list[Row], names: tuple[str, str], coarser: int) -> QuadMesh:
    """One map: cells of the share, crosses for the unexplained."""
    rows = [row for row in rows if float(row[names[0]]) > 0.0]
    x, y = (np.array([float(row[name]) for row in rows]) for name in names)
    critical = np.array([row["class"] == CONFIRMED for row in rows], dtype=float)
    edges = [EDGES[name][::coarser] for name in names]
    count, _, _ = np.histogram2d(x, y, bins=edges)
    share, _, _ = np.histogram2d(x, y, bins=edges, weights=critical)
    shown = np.ma.masked_where(count < FEWEST, 100.0 * share / np.maximum(count, 1.0))
    mesh = axes.pcolormesh(*edges, shown.T, cmap="cividis_r", vmin=0.0, vmax=50.0, edgecolors="none")
    odd = np.array([row["class"] == UNEXPLAINED for row in rows], dtype=bool)
    axes.plot(x[odd], y[odd], "x", color="black", markersize=5, markeredgewidth=1.2, label="unexplained")
    axes.plot([], [], "s", color="white", markeredgecolor="grey", label=f"white: fewer than {FEWEST} scenes")
    axes.set(xlabel=LABELS[names[0]], ylabel=LABELS[names[1]])
    axes.set(
        **{f"{letter}scale": "log" for letter, name in zip("xy", names, strict=True) if name in LOGARITHMIC}
    )
    for axis, name in zip((axes.xaxis, axes.yaxis), names, strict=True):
        if name in TICKS:
            axis.set_ticks(TICKS[name], [f"{tick:g}" for tick in TICKS[name]])
            axis.set_ticks([], minor=True)
    axes.set(xlim=edges[0][[0, -1]], ylim=edges[1][[0, -1]])
    axes.grid(False)
    return mesh
