"""Page of a campaign: ``stability.md``."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from validation.campaign.figure import TITLES, outcome_figure
from validation.campaign.scenes import CORNERS, MODELS
from validation.campaign.table import DISPLACEMENT, FORCE, version
from validation.campaign.verdict import (
    CLASSES,
    CONFIRMED,
    DEVIATES,
    ENDED,
    REFUSED,
    RIGHT,
    THROUGH,
    UNEXPLAINED,
)
from validation.study.document import Bullets, Heading, Picture, Table, Text, to_markdown
from validation.study.frames import frame_table
from validation.study.machine import versions
from validation.study.output import write_facts, write_files, write_text
from validation.study.plots import drawn

MEANING = {
    RIGHT: "to the full load or displacement: stable equilibria, on the branch of other runs",
    CONFIRMED: "up to a limit point or bifurcation that the verifier finds at the same load or displacement",
    THROUGH: "up to where coils pass through each other: the wire, or the circles, overlap by 0.1 diameters "
    "more than the deepest pair; the verifier finds as much by points of its own",
    ENDED: "friction, up to where Coulomb's law goes on but the iteration on updated bounds does not, or to "
    "where a sticking pair opens and its tangential force is lost; states before are verified",
    DEVIATES: "friction or no sliding: balanced, but other substeps change the answer by more than 2 %, from "
    "the first touch on; a pair keeps the vector of the end of its substep",
    REFUSED: "bad input, rejected in one sentence",
    UNEXPLAINED: "everything else",
}
NUMBERS = {
    "residual": "distance to the equilibrium over that from rest (beam); force left over the load (wire)",
    "branch": "difference from the run in one step and from the fine run over the largest displacement",
    "bracket": "width of the solver's bracket of a critical time, relative",
    "critical_shift": "change of a critical time by other steps or an invariance, relative",
    "confirmed": "distance of the verifier's sign change, fold, highest load or vanishing stiffness from the "
    "critical time, relative",
    "passed": "how far arc length stays stable beyond the critical time, relative",
    "overlap": "where coils pass through each other: the overlap found less that claimed, in wire diameters",
    "place": "prescribed displacement: distance of the top from where it is prescribed, relative",
    "reaction": "reported reaction to a prescribed displacement against the verifier's own, relative (beam; "
    "the wire's is in `residual`)",
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
    "In a fifth of the scenes UY of the top is prescribed, 4 to 104 % of the distance to solid, solid "
    "corners to 120 %; in the others a force acts. Under a prescribed displacement the verifier frees all "
    "but that motion: what is left must balance, the force there must be the reported reaction, and "
    "critical points are those of the constrained spring. A wire with friction or no sliding is verified "
    "by its other runs alone."
)
STEPS = (
    "Every scene is solved in three numbers of steps: one, a random one, and the multiple of that next to "
    "200 (twice at least). All must have one outcome; frictionless ones the same end time within 1e-4, and "
    "the same tips within 1e-6 of the largest displacement, or 1e-8 over the root of the least stiffness; "
    "with friction or no sliding both within 2 %."
)
CAPTION = (
    "Share of scenes, in per cent, that end at a limit point or bifurcation before full load, each of which "
    "the verifier finds at the same load by other means. Left: over penalty and steps; right: over "
    "slenderness and relative load, which is the prescribed share of the distance to solid, or the force "
    "over the one that makes the spring solid or deflects it by 1.2 heights. Crosses: unexplained."
)


def write_page(data: pd.DataFrame, out: Path, seed: int) -> None:
    """Write page and picture of the rows."""
    write_files(drawn(outcome_figure(data), "stability"), out)
    write_text(out / "stability.md", page(data, seed))
    counts = data.groupby([data["id"].str[0].map({"b": "beam", "w": "wire"}), "class"]).size()
    names = [(model, name) for model in ("beam", "wire") for name in CLASSES]
    write_facts({".".join(name): int(counts.get(name, 0)) for name in names}, out)


def page(data: pd.DataFrame, seed: int) -> str:
    """The page, Markdown."""
    used = ", ".join(f"{name} {number}" for name, number in versions().items() if number)
    model = data["id"].str[:1].map(TITLES)
    given = {f"{title}, {by}": (title, by) for title in TITLES.values() for by in (FORCE, DISPLACEMENT)}
    corners = {"none": "", **{name: name for name in CORNERS}}
    listed = data.loc[data["class"].isin((UNEXPLAINED, ENDED, DEVIATES, REFUSED))]
    listed = listed.assign(reason=listed["reason"].where(listed["reason"] != "", listed["message"]))
    listed = listed[["id", "corner", "outcome", "reason"]].rename(columns={"id": "case"})
    blocks = (
        Heading(1, "Stability campaign"),
        Text(f"Seed {seed}, sources {version()}, {used}."),
        Text(f"Any case again: `coilcheck stability --case ID --seed {seed}`."),
        Heading(2, "Outcome statistics"),
        _counts("model", {title: data[model == title] for title in TITLES.values()}),
        Bullets(tuple(f"*{name}*: {MEANING[name]}" for name in CLASSES)),
        Heading(2, "Forces and prescribed displacements"),
        Text(SAMPLED),
        _counts(
            "given", {name: data[(model == one) & (data["by"] == by)] for name, (one, by) in given.items()}
        ),
        Heading(2, "Numbers of steps"),
        Text(STEPS),
        Text(_stepped(data)),
        Picture("stability.png", CAPTION),
        Heading(2, "Corners"),
        _counts("corner", {name: data[data["corner"] == corner] for name, corner in corners.items()}),
        Heading(2, "Largest values measured: completed, critical and interpenetration alone"),
        _largest(data),
        Heading(2, "Invariances: largest change of the answer over the largest displacement"),
        _invariances(data),
        Text(CHANGES),
        Heading(2, "Unexplained, ended, deviating and refused"),
        frame_table(listed) if len(listed) else Text("None."),
    )
    return to_markdown(blocks)


def _counts(title: str, groups: dict[str, pd.DataFrame]) -> Table:
    """How many scenes of each group have each class."""
    counts = {
        name: rows["class"].value_counts().reindex(CLASSES, fill_value=0) for name, rows in groups.items()
    }
    return frame_table(pd.DataFrame(counts).T.rename_axis(title).reset_index())


def _stepped(data: pd.DataFrame) -> str:
    """How many scenes have a critical point that a run stepped over."""
    compared = data[data["stepped"] != ""]
    over = compared.loc[compared["stepped"].astype(float) > 0.0, "id"]
    named = f": {', '.join(over)}" if len(over) else ""
    return f"A run stepped over a critical point of another in {len(over)} of {len(compared)} scenes{named}."


def _most(data: pd.DataFrame, letter: str, name: str) -> str:
    """Largest value of a number among the explained scenes of a model."""
    explained = data["class"].isin((RIGHT, CONFIRMED, THROUGH)) & data["id"].str.startswith(letter)
    found = pd.to_numeric(data.loc[explained, name]).max()
    return "-" if pd.isna(found) else f"{found:.1e}"


def _largest(data: pd.DataFrame) -> Table:
    rows = ((name, *(_most(data, letter, name) for letter in MODELS), NUMBERS[name]) for name in NUMBERS)
    return Table(("number", *TITLES.values(), "meaning"), tuple(rows))


def _invariances(data: pd.DataFrame) -> Table:
    rows = []
    for kind, title in KINDS.items():
        mine = data[data["kind"] == kind]
        rows.append((title, str(len(mine)), *(_most(mine, letter, "invariance") for letter in MODELS)))
    return Table(("changed", "cases", *TITLES.values()), tuple(rows))
