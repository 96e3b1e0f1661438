"""What the wire model's contact moves and costs: ``python -m validation.verification.contact``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from coilspring import spring_a
from validation.study.document import to_markdown
from validation.study.frames import frame_table
from validation.study.output import write_facts, write_text
from validation.verification import contacttext as words
from validation.verification.contactruns import HELD, NONE, TIPS, Run, difference, limit_point, measured

PAGE, RECORD = Path("docs/contact.md"), Path("reports/contact")
CATALOGUE = {"A": 0.0, "B": NONE}  # coefficients of the catalogue's springs
TOLERANCE = 1e-8  # of the follower's equilibria
LIKE, FORCE = 0.01, 100.0  # mm, N: penetration at which all exponents give one force
SLIDES = 1e-9  # N mm: less work is none
REPEATS = 3  # timed runs, of which the least counts
STEPS = (10, 50, 200)
PAIRS = [Run(name, mu, pairs) for name, mu in CATALOGUE.items() for pairs in (4, 8, 20, 40)]
EXPONENTS = [
    Run(name, mu, k=k, K=FORCE * LIKE**-k) for name, mu in CATALOGUE.items() for k in (1.0, 1.5, 2.0)
]
FRICTION = [
    Run(name, mu, steps=steps)
    for name in CATALOGUE
    for mu in (0.0, 0.05, 0.1, 0.3, 1.0, NONE)
    for steps in STEPS
]
SEARCH = [
    Run(name, mu, pairs, K=K, steps=10, curved=True)
    for name, mu, K, pairs in (
        ("A", 0.0, 1e2, 40), ("A", 0.0, 3e1, 40), ("B", NONE, 1e2, 20), ("B", NONE, 1e2, 40),
        ("B", 0.0, 1e4, 4), ("B", 0.0, 1e4, 40), ("B", 0.0, 1e4, 80),
    )
]  # fmt: skip


def percent(share: float) -> str:
    """A share in percent, to two figures; 0 below a solver's tolerance."""
    return f"{100.0 * share:.2g} %" if share > TOLERANCE else "0"


def _tip(value: float) -> str:
    return f"{value:.4f}" if abs(value) > HELD else "0"


def _coefficient(mu: float) -> str:
    return "no sliding" if mu == NONE else f"{mu:g}"


def _table(data: pd.DataFrame, columns: Mapping[str, tuple[str, Any]]) -> str:
    """Columns of the data as a table and an empty line; for each its title and format."""
    formats = dict.fromkeys(TIPS, _tip) | dict(columns.values())
    chosen = data.reindex(columns=list(columns)).set_axis([title for title, _ in columns.values()], axis=1)
    return to_markdown((frame_table(chosen, formats),)) + "\n"


def _titled(*names: str, **columns: tuple[str, Any]) -> dict[str, tuple[str, Any]]:
    return {name: (name, _tip if name in TIPS else "{}") for name in names} | columns


def pairs_section(data: pd.DataFrame, slip: float) -> str:
    """What the number of pairs per turn moves and costs; `slip` is Spring A's largest at the least mu, mm."""
    springs = [group for _, group in data.groupby("spring", sort=False)]
    data = pd.concat(
        group.assign(
            difference=difference(group, group.iloc[-1]), time=group["seconds"] / group["seconds"].iloc[0]
        )
        for group in springs
    )
    columns = {
        "spring": ("spring", "{}"), "pairs": ("pairs per turn", "{}"), **_titled(*TIPS),
        "difference": ("difference to 40", percent), "overlap": ("overlap of the wires", "{:.4f}"),
        "penetration": ("largest penetration of a pair", "{:.4f}"),
        "force": ("largest force of a pair", "{:.2f}"), "time": ("time over that of 4", "{:.1f}"),
    }  # fmt: skip
    few, many = data[data["pairs"] == 4], data[data["pairs"] == 40].set_index("spring")
    costs = (
        f"{row['spring']} {row['overlap']:.3f} mm of overlap ({many['overlap'][row['spring']]:.3f} with 40), "
        f"{percent(row['difference'])} of the tips"
        for _, row in few.iterrows()
    )
    still = data.loc[(data["spring"] == "A") & (data["pairs"] == 20), "difference"].item()
    sink = slip**2 / (2.0 * spring_a().spring.wire_diameter)
    said = words.PAIRS_WORDS.format(
        costs=";\n".join(costs), still=percent(still), slip=slip, sink=sink, mu=0.05
    )
    return words.PAIRS_TEXT + _table(data, columns) + said


def exponent_section(data: pd.DataFrame) -> str:
    """What the exponent of the penalty moves."""
    springs = [group for _, group in data.groupby("spring", sort=False)]
    data = pd.concat(group.assign(difference=difference(group, group.iloc[0])) for group in springs)
    columns = {
        "spring": ("spring", "{}"), "k": ("k", "{:g}"), "K": ("K, N/mm^k", "{:g}"), **_titled(*TIPS),
        "difference": ("difference to k = 1", percent), "penetration": ("largest penetration", "{:.4f}"),
        "force": ("largest force of a pair", "{:.2f}"), "factorisations": ("factorisations", "{}"),
    }  # fmt: skip
    return words.EXPONENT_TEXT.format(force=FORCE, like=LIKE) + _table(data, columns)


def friction_section(data: pd.DataFrame) -> str:
    """What friction moves, and what of it depends on the substeps."""
    rows = pd.DataFrame([friction_row(runs) for _, runs in data.groupby(["spring", "mu"], sort=False)])
    columns = {
        "spring": ("spring", "{}"), "mu": ("mu", _coefficient), **_titled(*TIPS),
        "work": ("work of friction, N mm", lambda work: f"{work:.3g}" if work > SLIDES else "0"),
        "largest slip": ("largest slip", "{:.4f}"), "couple": ("couple left, N mm", "{:.2f}"),
        "change": ("change of the tips", percent), "work change": ("change of the work", percent),
    }  # fmt: skip
    columns["UX"] = ("UX", lambda value: value if isinstance(value, str) else _tip(value))
    text = words.FRICTION_TEXT.format(most=STEPS[-1], fewer=" and ".join(map(str, STEPS[:-1])))
    last = data[(data["spring"] == "A") & (data["steps"] == STEPS[-1])].set_index("mu")
    moment = last["moment"][NONE]
    small, middle, none = (percent(last["couple"][mu] / moment) for mu in (0.1, 0.3, NONE))
    return text + _table(rows, columns) + words.FRICTION_WORDS.format(
        moment=moment, small=small, middle=middle, none=none
    )  # fmt: skip


def friction_row(runs: pd.DataFrame) -> dict[str, Any]:
    """A row of the table of friction from runs in several numbers of steps, the most last."""
    last = runs.iloc[-1]
    head = last[["spring", "mu"]].to_dict()
    if last["outcome"] != "completed":
        return head | {"UX": f"{last['outcome']} at t = {last['critical time']:.4f}"}
    row = last[["spring", "mu", *TIPS, "work", "largest slip", "couple"]].to_dict()
    row["change"] = difference(runs, last).max()
    if last["work"] > SLIDES:
        row["work change"] = (runs["work"] / last["work"] - 1.0).abs().max()
    return row


def search_section(data: pd.DataFrame, listed: int, limit: Mapping[str, Any]) -> str:
    """What the search for further pairs finds; `listed` by the runs of the first table."""
    time = data["critical time"].map(lambda at: "" if pd.isna(at) else f" at t = {at:.4f}")
    columns = {
        "spring": ("spring", "{}"), "mu": ("mu", _coefficient), "K": ("K", "{:g}"),
        "pairs": ("pairs per turn", "{}"), **_titled("pairs found", "outcome", "UX", "UY"),
        "penetration": ("largest penetration", "{:.3f}"), "unlisted": ("unlisted", "{}"),
    }  # fmt: skip
    table = _table(data.assign(outcome=data["outcome"] + time), columns)
    return words.SEARCH_TEXT + table + words.SEARCH_WORDS.format(listed=listed, **limit)


def page(
    pairs: pd.DataFrame,
    exponents: pd.DataFrame,
    friction: pd.DataFrame,
    search: pd.DataFrame,
    limit: Mapping[str, Any],
) -> str:
    """The page, a view of the runs."""
    slip = friction.query("spring == 'A' and mu == 0.05 and steps == 50")["last slip"].item()
    sections = (
        pairs_section(pairs, slip), exponent_section(exponents), friction_section(friction), words.SOLVER,
        search_section(search, int(pairs["pairs found"].sum()), limit),
    )  # fmt: skip
    return (words.HEAD + "".join(sections)).replace("\n\n\n", "\n\n")


def facts(
    pairs: pd.DataFrame, friction: pd.DataFrame, search: pd.DataFrame, limit: Mapping[str, Any]
) -> dict[str, object]:
    """What findings are computed from: mm, and shares in per cent."""
    found: dict[str, object] = {"pairs.count": int(pairs["pairs"].iloc[0])}
    for name, group in pairs.groupby("spring", sort=False):
        found[f"pairs.{name}.overlap"] = group["overlap"].iloc[0]
        found[f"pairs.{name}.difference"] = 100.0 * difference(group, group.iloc[-1]).iloc[0]
    last = friction[(friction["spring"] == "A") & (friction["steps"] == STEPS[-1])].set_index("mu")
    found["friction.couples"] = 100.0 * last["couple"][NONE] / last["moment"][NONE]
    found |= {"friction.free": last["UY"][0.0], "friction.held": last["UY"][NONE]}
    most = search.iloc[-1]
    found |= {"search.pairs": int(most["pairs"]), "search.outcome": most["outcome"]}
    return found | {"search.along": limit["circ"]}


def write_page(path: Path, record: Path) -> None:
    """Solve all, write the page, and the facts into the folder `record`."""
    pairs = measured(PAIRS, REPEATS)
    exponents, friction, search = map(measured, (EXPONENTS, FRICTION, SEARCH))
    limit = limit_point()
    write_text(path, page(pairs, exponents, friction, search, limit))
    write_facts(facts(pairs, friction, search, limit), record)


if __name__ == "__main__":
    write_page(PAGE, RECORD)
