"""Where each model stands against 3D elasticity: ``python -m validation.solid.page``.

Rods are solved here; solids are those that `validation.solid.runs` has written.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import wirefe
from coilspring import CATALOGUE, EquilibriumPath, Material, Scene, Spring, spring_a
from coilspring.scene.sizing import wahl_factor
from coilspring.scene.solidwire import coil_section, half_ring, inner_stress_factor
from coilspring.scene.wire import round_section
from validation.solid.comparison import COILS as COILS_RUN
from validation.solid.comparison import DIRECTIONS, KINDS, MODELS, solved
from validation.solid.runs import FOLDER
from validation.study.document import Block, Heading, Table, Text, to_markdown
from validation.study.frames import Format, frame_table, read_csv, write_csv
from validation.study.metrics import compare_paths
from validation.study.output import write_facts, write_text
from validation.study.partialsolve import ending, partial_path
from validation.study.statements import Statement, rendered, statement

INDICES = (3.0, 4.0, 5.0, 20.0 / 3.0, 8.0, 10.0, 15.0)
AXIAL, OTHERS = 0.3, 0.5  # per cent: what the wire model with the solid wire must hold
SIGNED, PERCENT = "{:+.2f}".format, "{:.2f}".format
INTRO = (
    "Written by `python -m validation.solid.page`; solids by `python -m validation.solid.runs`. Both models "
    "take their wire for a straight rod with shear unless `[spring] wire_rigidity` is `solid`: then it has "
    "the flexibility of the coiled wire by three-dimensional elasticity, from finite elements on its section "
    "([theory](../../docs/theory.md#5-the-wire-as-a-solid-body)). Wire model: 16 curved elements per turn."
)
RATES = (
    "Stiffness of a closely coiled spring's half coil over the paper's, by the section: what changes in the "
    "equivalent beam, and the four stiffnesses of a rod that has them. nu = 0.3; the paper's axial "
    "stiffness is the textbook's, G d^4/(8 D^3 n)."
)
STRESSES = "Shear stress at the inside of the coil over 8 F D/(pi d^3), by the section and by Wahl's formula."
COILS = (
    "Flexibility of coils, clamped at the bottom, the top section rigid with the reference point on the "
    "axis, over that of fine solids (CalculiX, C3D20R), in per cent. *Mesh*: coarse solids, with elements of "
    "twice the size in the section. *Whole*: the largest difference of an entry of the 6 x 6 matrix over the "
    "root of its diagonal entries."
)
LARGE = (
    "The catalogue's springs without contact at full load, in large deflection; *off*: the largest "
    "difference of a component from the finer solids, in per cent of that component."
)
PAPER = "paper's law"
STANDING = (
    "Largest difference of the load curves from the wire model with the solid wire, in per cent of the "
    "component's peak: without contact that model was checked against solids above; contact is by the "
    "catalogue's 4 sphere pairs per turn in all. *Paper's mesh*: 40 straight elements per turn."
)


def ring_table() -> pd.DataFrame:
    """Stiffnesses with the solid wire over the paper's or the straight wire's, %."""
    rows = []
    for index in INDICES:
        spring = Spring(1.0, (index, index), 1.0, 1.0, end_turns=0.0)
        radius, material = np.array([index / 2.0]), Material()
        coiled = coil_section(replace(spring, wire_rigidity="solid"), material, 1.0 / radius)
        straight = round_section(1.0, material)
        rigid = replace(straight, EA=np.inf, GA=np.inf)  # as the paper's law has it
        change = half_ring(coiled, radius)[0] / half_ring(rigid, radius)[0] - 1.0
        beam = half_ring(straight, radius)[0, 0] / half_ring(rigid, radius)[0, 0] - 1.0
        stretch = {name: float(getattr(straight, name) / getattr(coiled, name)[0]) for name in ("EA", "GA")}
        stiff = {name: float(getattr(coiled, name)[0] / getattr(straight, name)) for name in ("GJ", "EI")}
        rows.append(
            {
                "index": f"{index:.3g}",
                **{f"{name} (%)": 100.0 * x for name, x in zip(("Kax", "Ksh", "Kfl"), change, strict=True)},
                "Kax of a rod with shear (%)": 100.0 * beam,
                **{f"{name} (%)": 100.0 * (x - 1.0) for name, x in stiff.items()},
                **{f"1/{name}, share": x for name, x in stretch.items()},
            }
        )
    return pd.DataFrame(rows)


def stress_table() -> pd.DataFrame:
    """Stress factors."""
    found = pd.DataFrame({"index": INDICES})
    for nu in (0.0, 0.3, 0.5):
        found[f"nu = {nu:g}"] = [inner_stress_factor(index, nu) for index in INDICES]
    found["Wahl"] = [wahl_factor(index) for index in INDICES]
    found["Wahl off, nu = 0.3 (%)"] = 100.0 * (found["Wahl"] / found["nu = 0.3"] - 1.0)
    return found


def standing() -> pd.DataFrame:
    """Difference of every model and wire from the wire model with the solid wire, a row a scene and model."""
    rows = []
    for name, scene in CATALOGUE.items():
        reference = solved(scene(), "wire model", "solid")
        for model in (*MODELS, "paper's mesh"):
            for kind in KINDS:
                path = _paper_mesh(scene(), kind) if model == "paper's mesh" else solved(scene(), model, kind)
                off = 100.0 * compare_paths(path, reference).curve_max
                rows.append({"scene": name, "model": model, "wire": kind, "off": off, "ending": _ended(path)})
    return pd.DataFrame(rows)


def _paper_mesh(scene: Scene, kind: str) -> EquilibriumPath:
    return partial_path(wirefe.solve, replace(scene, spring=replace(scene.spring, wire_rigidity=kind)))


def _ended(path: EquilibriumPath) -> str:
    return "" if path.outcome == "completed" else ending(path.outcome, path.critical_time)


def numbers(coils: pd.DataFrame, moved: pd.DataFrame, stands: pd.DataFrame) -> dict[str, Any]:
    """Facts of the page and of findings, in per cent."""
    long, coils = coils[coils["coils"] > COILS_RUN], coils[coils["coils"] == COILS_RUN]
    axial = coils["direction"] == "Fy"
    section = ring_table().set_index("index")
    a = f"{spring_a().spring.mean_diameter[0] / spring_a().spring.wire_diameter:.3g}"
    facts = {
        "axial": coils.loc[axial, "solid"].abs().max(),
        "others": coils.loc[~axial, "solid"].abs().max(),
        "whole": coils["solid_whole"].max(),
        "beam.axial": coils.loc[axial, "beam"].abs().max(),
        "beam.others": coils.loc[~axial, "beam"].abs().max(),
        "mesh": coils["mesh"].abs().max(),
        "coils": coils["coils"].iloc[0],
        "index": long["index"].iloc[0],
        "long": long["coils"].iloc[0],
        "others.long": long.loc[long["direction"] != "Fy", "solid"].abs().max(),
        "rate.solid": section.loc[a, "Kax (%)"],
        "rate.beam": section.loc[a, "Kax of a rod with shear (%)"],
        "lateral": section.loc[a, "Ksh (%)"],
        "bending": section.loc[a, "Kfl (%)"],
    }
    for row in moved.itertuples():
        facts[f"large.{row.scene}.{row.model}.{row.wire}"] = row.off
    for row in stands.itertuples():
        facts[f"standing.{row.scene}.{row.model}.{row.wire}"] = row.off
    numbers = {name: float(value) for name, value in facts.items()}
    return numbers | {"indices": sorted(map(float, coils["index"].unique()))}


@statement("solid.coils")
def coils_hold(f: Mapping[str, Any]) -> str:
    holds = f["axial"] <= AXIAL and f["others"] <= OTHERS
    less = "falls" if f["others.long"] < f["others"] else "does not fall"
    return (
        f"With the solid wire the wire model is {'' if holds else 'not '}within {AXIAL:g} % in the axial "
        f"direction and {OTHERS:g} % in the others: at most {f['axial']:.3f} and {f['others']:.2f} %, "
        f"{f['whole']:.2f} % in any entry. The coarse solids differ from the fine ones by up to "
        f"{f['mesh']:.2f} %. Rods of beams are off by up to {f['beam.axial']:.1f} and "
        f"{f['beam.others']:.1f} %. Clamped ends keep the section from warping, which no rod knows: what is "
        f"left {less} with the number of coils, at index {f['index']:g} to {f['others.long']:.2f} % with "
        f"{f['long']:g} coils."
    )


@statement("solid.rates")
def rates(f: Mapping[str, Any]) -> str:
    nearer = abs(f["rate.solid"]) < abs(f["rate.solid"] - f["rate.beam"])
    return (
        f"At Spring A's index the paper's axial stiffness changes by {f['rate.solid']:+.2f} %, the shearing "
        f"by {f['lateral']:+.2f} %, the bending by {f['bending']:+.2f} %. A rod with shear changes the axial "
        f"one by {f['rate.beam']:+.2f} %: {'away from' if nearer else 'towards'} the solid's, from which the "
        f"textbook's formula is the {'nearer' if nearer else 'farther'} one."
    )


@statement("solid.standing")
def stands_words(f: Mapping[str, Any]) -> str:
    bare = {
        (spring, model, kind): f[f"standing.spring-{spring}-no-contact.{model}.{kind}"]
        for spring in "ab"
        for model in MODELS
        for kind in KINDS
    }
    closer = [bare[spring, "helix law", "solid"] < bare[spring, PAPER, "beam"] for spring in "ab"]
    so = "nearer to 3D elasticity than" if all(closer) else "not nearer to 3D elasticity in both than"
    worse = [s.upper() for s in "ab" if bare[s, "helix law", "beam"] > bare[s, PAPER, "beam"]]
    beams = (
        f"with the wire of beams it is farther off than the paper's law on Spring {' and '.join(worse)}"
        if worse
        else "with the wire of beams it is, too"
    )
    return (
        f"Without contact the helix law with the solid wire is {so} the paper's law: "
        + "; ".join(
            f"Spring {s.upper()} {bare[s, 'helix law', 'solid']:.2f} against {bare[s, PAPER, 'beam']:.2f} %"
            for s in "ab"
        )
        + f"; {beams} ({bare['a', 'helix law', 'beam']:.2f} and {bare['b', 'helix law', 'beam']:.2f} %)."
    )


def page(facts: Mapping[str, Any], coils: pd.DataFrame, moved: pd.DataFrame, stands: pd.DataFrame) -> str:
    """The page as Markdown."""
    rows = []
    for (count, index, angle), group in coils.groupby(["coils", "index", "angle"]):
        for name in ("beam", "solid", "mesh"):
            whole = group[f"{name}_whole"].iloc[0]
            values = (*map(SIGNED, group[name]), PERCENT(whole))
            rows.append((f"{count:g}", f"{index:.3g}", f"{angle:g}", name, *values))
    head = ("coils", "index", "pitch (degrees)", "wire", *DIRECTIONS, "whole")
    apart = stands.assign(off=[f"{r.off:.2f} {r.ending}".strip() for r in stands.itertuples()])
    apart = apart.assign(model=apart["model"] + ", " + apart["wire"])
    wide = apart.pivot(index="model", columns="scene", values="off").loc[apart["model"].unique()]
    ring = ring_table()
    fixed: dict[str, Format] = dict.fromkeys(("nu = 0", "nu = 0.3", "nu = 0.5", "Wahl"), "{:.4f}")
    parts: tuple[Block | Statement, ...] = (
        Heading(1, "The wire as a solid body"),
        Text(INTRO),
        Heading(2, "Where each model stands against 3D elasticity"),
        Text(STANDING),
        frame_table(wide.reset_index()[["model", *CATALOGUE]]),
        stands_words,
        Heading(2, "Coils against solids"),
        Text(COILS),
        Table(head, tuple(rows)),
        coils_hold,
        Heading(2, "Large deflection against solids"),
        Text(LARGE),
        frame_table(moved, dict.fromkeys(("ux", "uy", "rotz"), "{:.4f}") | {"off": PERCENT}),
        Heading(2, "Stiffness of a half coil"),
        Text(RATES),
        frame_table(ring, {name: PERCENT if "share" in name else SIGNED for name in ring.columns[1:]}),
        rates,
        Heading(2, "Stress at the inside of the coil"),
        Text(STRESSES),
        frame_table(stress_table(), fixed | {"index": "{:.3g}", "Wahl off, nu = 0.3 (%)": SIGNED}),
    )
    return to_markdown(rendered(parts, facts))


def main(folder: Path = FOLDER) -> None:
    """Solve rods and write page, standing.csv and facts."""
    coils, moved = (read_csv(folder / f"{name}.csv") for name in ("flexibility", "deflection"))
    stands = standing()
    write_csv(stands, folder / "standing.csv")
    facts = numbers(coils, moved, stands)
    write_facts(facts, folder)
    write_text(folder / "solid.md", page(facts, coils, moved, stands))


if __name__ == "__main__":
    main()
