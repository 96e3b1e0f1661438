"""What the wire model's contact moves and costs: ``python -m validation.verification.contact``."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from pathlib import Path
from typing import Any

import pandas as pd

from coilspring import spring_a
from validation.study import template
from validation.study.output import write_facts, write_text
from validation.verification.contactruns import HELD, NONE, TIPS, Run, difference, limit_point, measured

PAGE, RECORD = Path("docs/contact.md"), Path("reports/contact")
CATALOGUE = {"A": 0.0, "B": NONE}  # coefficients of the catalogue's springs
TOLERANCE = 1e-8  # of the follower's equilibria
LIKE, FORCE = 0.01, 100.0  # mm, N: penetration at which all exponents give one force
SLIDES = 1e-9  # N mm: less work is none
REPEATS = 3  # timed runs, of which the least counts
STEPS = (10, 50, 200)
KINDS = (("spheres", 4), ("spheres", 20), ("wires", 16), ("wires", 32), ("wires", 64))
RUNS = {
    "pairs": [Run(name, mu, pairs) for name, mu in CATALOGUE.items() for pairs in (4, 8, 20, 40)],
    "exponents": [
        Run(name, mu, k=k, K=FORCE * LIKE**-k) for name, mu in CATALOGUE.items() for k in (1.0, 1.5, 2.0)
    ],
    "friction": [
        Run(name, mu, steps=steps)
        for name, mu, steps in product(CATALOGUE, (0.0, 0.05, 0.1, 0.3, 1.0, NONE), STEPS)
    ],
    "search": [
        Run(name, mu, pairs, K=K, steps=10, curved=True)
        for name, mu, K, pairs in (
            ("A", 0.0, 1e2, 40), ("A", 0.0, 3e1, 40), ("B", NONE, 1e2, 20), ("B", NONE, 1e2, 40),
            ("B", 0.0, 1e4, 4), ("B", 0.0, 1e4, 40), ("B", 0.0, 1e4, 80),
        )
    ],
    "geometry": [
        Run(name, mu, pairs, geometry=geometry)
        for name, mu, (geometry, pairs) in product(CATALOGUE, (0.0, 0.1, 0.2, 0.3, NONE), KINDS)
    ],
    "phases": [
        Run("A", 0.0, pairs, geometry=geometry, degrees=degrees)
        for degrees, (geometry, pairs) in product((0.0, 11.25, 22.5, 45.0), (*KINDS[:2], KINDS[3]))
    ],
    "cycles": [Run("cycle", 0.1, pairs, geometry=geometry) for geometry, pairs in KINDS],
}  # fmt: skip
Runs = Mapping[str, pd.DataFrame]


def percent(share: float) -> str:
    """A share in percent, to two figures; 0 below a solver's tolerance."""
    return f"{100.0 * share:.2g} %" if share > TOLERANCE else "0"


def tip(run: Mapping[str, Any], components: int = 3) -> str:
    """Cells of the first components of a run's tip."""
    values = [run[name] for name in TIPS[:components]]
    return " | ".join(f"{value:.4f}" if abs(value) > HELD else "0" for value in values)


def coefficient(mu: float) -> str:
    """A coefficient of friction, or that nothing slides."""
    return "no sliding" if mu == NONE else f"{mu:g}"


WORDS = template.template(Path(__file__).with_name("contact.md"), [percent, tip, coefficient, pd.notna])


def beside(data: pd.DataFrame, by: str | list[str], reference: int = -1) -> pd.DataFrame:
    """Runs with their difference from one of their group."""
    return pd.concat(
        group.assign(difference=difference(group, group.iloc[reference]))
        for _, group in data.groupby(by, sort=False)
    )


def friction_row(runs: pd.DataFrame) -> dict[str, Any]:
    """Of runs in several numbers of steps the last, in the most, and by what the others differ."""
    last = runs.iloc[-1]
    row = last.to_dict() | {"change": difference(runs, last).max()}
    if last["work"] > SLIDES:
        row["work change"] = (runs["work"] / last["work"] - 1.0).abs().max()
    return row


def page(runs: Runs, limit: Mapping[str, Any]) -> str:
    """The page, a view of the runs."""
    pairs, friction = beside(runs["pairs"], "spring"), runs["friction"]
    pairs["time"] = pairs["seconds"] / pairs.groupby("spring")["seconds"].transform("first")
    few, many = (pairs[pairs["pairs"] == count].set_index("spring") for count in (4, 40))
    costs = few.assign(many=many["overlap"])[["overlap", "many", "difference"]].reset_index()
    last = _last(friction)
    return template.page(
        WORDS,
        pairs=pairs.to_dict("records"),
        exponents=beside(runs["exponents"], "spring", 0).to_dict("records"),
        friction=[friction_row(group) for _, group in friction.groupby(["spring", "mu"], sort=False)],
        search=runs["search"].to_dict("records"),
        wires=against_wires(runs),
        costs=costs.to_dict("records"),
        still=pairs.loc[(pairs["spring"] == "A") & (pairs["pairs"] == 20), "difference"].item(),
        slip=friction.query("spring == 'A' and mu == 0.05 and steps == 50")["last slip"].item(),
        couples=[last["couple"][mu] for mu in (0.1, 0.3, NONE)],
        moment=last["moment"][NONE],
        listed=int(pairs["pairs found"].sum()),
        d=spring_a().spring.wire_diameter,
        **{"force": FORCE, "like": LIKE, "steps": STEPS, "limit": limit, "least_work": SLIDES},
    )


def _last(friction: pd.DataFrame) -> pd.DataFrame:
    """Runs of Spring A in the most steps, by their coefficients."""
    return friction[(friction["spring"] == "A") & (friction["steps"] == STEPS[-1])].set_index("mu")


def against_wires(runs: Runs) -> dict[str, list[dict[str, Any]]]:
    """Rows of spheres and of wires, each with its difference from the 64 stations of the same case."""
    cycles = runs["cycles"]
    tables = {
        "friction": beside(runs["geometry"], ["spring", "mu"]),
        "phases": beside(runs["phases"], "degrees"),
        "cycles": cycles.assign(difference=cycles["work"] / cycles["work"].iloc[-1] - 1.0),
    }
    return {name: table.to_dict("records") for name, table in tables.items()}


def facts(runs: Runs, limit: Mapping[str, Any]) -> dict[str, object]:
    """What findings are computed from: mm, and shares in per cent."""
    pairs, last, most = beside(runs["pairs"], "spring"), _last(runs["friction"]), runs["search"].iloc[-1]
    found: dict[str, object] = {"pairs.count": int(pairs["pairs"].iloc[0])}
    for row in pairs.groupby("spring", sort=False).head(1).itertuples():
        found[f"pairs.{row.spring}.overlap"] = row.overlap
        found[f"pairs.{row.spring}.difference"] = 100.0 * row.difference
    found["friction.couples"] = 100.0 * last["couple"][NONE] / last["moment"][NONE]
    found |= {"friction.free": last["UY"][0.0], "friction.held": last["UY"][NONE]}
    found |= {"search.pairs": int(most["pairs"]), "search.outcome": most["outcome"]}
    rows = against_wires(runs)
    for row in rows["friction"]:
        key = f"{row['geometry']}.{row['spring']}.{row['mu']:g}.{row['pairs']}"
        found |= {f"{key}.outcome": row["outcome"], f"{key}.time": row["critical time"]}
        found |= {f"{key}.UY": row["UY"], f"{key}.difference": 100.0 * row["difference"]}
    found |= {f"cycle.{row['geometry']}.{row['pairs']}": row["work"] for row in rows["cycles"]}
    return found | {"search.along": limit["circ"]}


def write_page(path: Path, record: Path) -> None:
    """Solve all, write the page, and the facts into the folder `record`."""
    runs = {name: measured(group, REPEATS if name == "pairs" else 1) for name, group in RUNS.items()}
    limit = limit_point()
    write_text(path, page(runs, limit))
    write_facts(facts(runs, limit), record)


if __name__ == "__main__":
    write_page(PAGE, RECORD)
