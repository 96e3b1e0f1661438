"""Where each model stands against 3D elasticity: ``python -m validation.solid.page``.

Rods are solved here; solids are those that `validation.solid.runs` has written.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from coilspring import CATALOGUE, Material, Spring, spring_a
from coilspring.curves import COMPONENTS, compare_paths
from coilspring.scene.sizing import wahl_factor
from coilspring.scene.solidwire import coil_section, half_ring, inner_stress_factor
from coilspring.scene.wire import round_section
from validation.solid.comparison import COILS as COILS_RUN
from validation.solid.comparison import DIRECTIONS, KINDS, SOLVERS, TITLES, solved
from validation.solid.hexahedra import COARSE, MIDDLE
from validation.solid.runs import FOLDER, SCENES
from validation.study import template
from validation.study.files import write_facts, write_text
from validation.study.frames import Format, frame_table, read_csv, write_csv
from validation.study.partialsolve import ending

INDICES = (3.0, 4.0, 5.0, 20.0 / 3.0, 8.0, 10.0, 15.0)
SIGNED, PERCENT = "{:+.2f}".format, "{:.2f}".format


def ring_table() -> pd.DataFrame:
    """Stiffnesses with the solid wire over the paper's or the straight wire's, %."""
    rows = []
    for index in INDICES:
        spring = Spring(1.0, (index, index), 1.0, 1.0, end_turns=0.0)
        radius, material = np.array([index / 2.0]), Material()
        coiled = coil_section(replace(spring, wire_rigidity="solid"), material, 1.0 / radius)
        straight = round_section(1.0, material)
        paper = half_ring(replace(straight, EA=np.inf, GA=np.inf), radius)[0]  # its law has no such strains
        Kax, Ksh, Kfl = 100.0 * (half_ring(coiled, radius)[0] / paper - 1.0)
        rod = 100.0 * (half_ring(straight, radius)[0, 0] / paper[0] - 1.0)
        stiff = [100.0 * (getattr(coiled, name)[0] / getattr(straight, name) - 1.0) for name in ("GJ", "EI")]
        shares = [getattr(straight, name) / getattr(coiled, name)[0] for name in ("EA", "GA")]
        rows.append((f"{index:.3g}", Kax, Ksh, Kfl, rod, *stiff, *shares))
    heads = ("Kax (%)", "Ksh (%)", "Kfl (%)", "Kax of a rod with shear (%)", "GJ (%)", "EI (%)")
    return pd.DataFrame(rows, columns=["index", *heads, "1/EA, share", "1/GA, share"])


def standing() -> pd.DataFrame:
    """Difference of every model and wire from the wire model with the solid wire, a row a scene and model."""
    rows = []
    for name, scene in CATALOGUE.items():
        reference = solved(scene(), "wire model", "solid")
        for model, kind in product(SOLVERS, KINDS):
            path = solved(scene(), model, kind)
            off = 100.0 * compare_paths(path, reference).curve_max
            ended = "" if path.outcome == "completed" else ending(path.outcome, path.critical_time)
            rows.append({"scene": name, "model": model, "wire": kind, "off": off, "ending": ended})
    return pd.DataFrame(rows)


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
        "mesh.long": long["mesh"].abs().max(),
        "coils": coils["coils"].iloc[0],
        "index": long["index"].iloc[0],
        "long": long["coils"].iloc[0],
        "others.long": long.loc[long["direction"] != "Fy", "solid"].abs().max(),
        "rate.solid": section.loc[a, "Kax (%)"],
        "rate.beam": section.loc[a, "Kax of a rod with shear (%)"],
        "lateral": section.loc[a, "Ksh (%)"],
        "bending": section.loc[a, "Kfl (%)"],
    }
    for name, data in (("large", moved), ("standing", stands)):
        facts |= {f"{name}.{row.scene}.{row.model}.{row.wire}": row.off for row in data.itertuples()}
    numbers = {name: float(value) for name, value in facts.items()}
    return numbers | {"indices": sorted(map(float, coils["index"].unique()))}


def solids_error(facts: Mapping[str, Any]) -> float:
    """What the solids in large deflection change from the coarse to the finer mesh, %."""
    return max(facts[f"large.{scene}.solids.coarse"] for scene in SCENES)


def ranked(facts: Mapping[str, Any], resolved: bool) -> list[tuple[str, float]]:
    """Models with their difference from the finer solids, %: by more than `solids_error` or others."""
    own, found = solids_error(facts), []
    for scene, model, kind in product(SCENES, TITLES, KINDS):
        off = facts[f"large.{scene}.{model}.{kind}"]
        if (off > own) == resolved:
            found.append((f"{model}, {kind}", off))
    return sorted(found, key=lambda pair: pair[1])


WORDS = template.template(Path(__file__).with_name("page.md"), [solids_error, ranked])
WORDS.globals.update(catalogue=list(CATALOGUE), directions=DIRECTIONS, meshes=(COARSE, MIDDLE))


def page(facts: Mapping[str, Any], coils: pd.DataFrame, moved: pd.DataFrame, stands: pd.DataFrame) -> str:
    """The page as Markdown."""
    ring, factors = ring_table(), pd.DataFrame({"index": INDICES})
    factors["3D elasticity"] = factors["index"].map(inner_stress_factor)
    factors["Wahl"] = factors["index"].map(wahl_factor)
    factors["Wahl off (%)"] = 100.0 * (factors["Wahl"] / factors["3D elasticity"] - 1.0)
    own = solids_error(facts)
    below = (moved["off"] <= own) & (moved["model"] != "solids")
    off = moved["off"].map(PERCENT).mask(below, f"below {own:.2f}")
    fixed: dict[str, Format] = dict.fromkeys(("3D elasticity", "Wahl"), "{:.4f}")
    return template.page(
        WORDS,
        f=facts,
        stands=stands.fillna({"ending": ""}),
        coils=coils,
        moved=frame_table(moved.assign(off=off), dict.fromkeys(COMPONENTS, "{:.4f}")),
        ring=frame_table(ring, {name: PERCENT if "share" in name else SIGNED for name in ring.columns[1:]}),
        stress=frame_table(factors, fixed | {"index": "{:.3g}", "Wahl off (%)": SIGNED}),
    )


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
