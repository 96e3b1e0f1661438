"""The page on accuracy on request: tables, and what the sentences of ``requestedpage.md`` count."""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from coilspring.words import counted
from validation.study import template
from validation.study.frames import frame_table
from validation.study.metrics import CONFIDENCE, upper_bound
from validation.study.sections import MOST_SECTIONS
from validation.study.tables import Table
from validation.verification import requestedruns
from validation.verification.requestedruns import REFUSED

SPRING = ["seed", "kind", "number"]  # what identifies a spring
# What its coils do, as the page has it.
OPEN, FREE, HELD, WIRES, ROUGH = (
    *("coils that do not touch", "spheres that slide freely", "spheres that stick or have friction"),
    *("wires that slide freely", "wires that stick or have friction"),
)
COILS = (OPEN, FREE, HELD, WIRES, ROUGH)
RATE = 0.01  # of answers that are off by more than asked: the bound is compared with it
MOST = 0.9  # share of the springs, of whose reference the error is said
WORST = 10  # answers in the table of the worst
# Seeds whose rows were known when the factors of `wirefe.trials` were chosen.
SEEN = (
    *(20, 3125, 8201, 8202, 8211, 8212, 8221, 8222, 8231, 8232, 8241, 8242, 8261, 8262, 8271, 8272),
    *(8311, 8312, 8321, 8322, 8331, 8332, 8347, 8348, 8349, 8350, 8351, 8352, 8353, 8354, 8361, 8362),
    *(8371, 8372, 8373, 8374),
)
HEADS = {
    **{"asked": "accuracy", "springs": "springs", "refused": "refused", "failures": "off by more than asked"},
    **{"bound": "bound of their rate (%)", "certain": "not by the reference's error"},
    **{
        "ratio": "estimate over error",
        "time": "time",
        "time_90": "slowest tenth",
        "time_all": "all together",
    },
}


def prepared(rows: pd.DataFrame) -> pd.DataFrame:
    """The rows, with what coils do, the error over that asked for, the time over that of the cheapest run."""
    spheres, free = rows.contact.str.startswith("spheres"), rows.contact.str.endswith("free")
    which = [rows.closed == 0, spheres & free, spheres, free]
    coils = np.select(which, [OPEN, FREE, HELD, WIRES], ROUGH)
    off, times = rows.true / rows.asked, rows.seconds / rows.cheapest
    return rows.assign(coils_do=coils, answered=rows.outcome != REFUSED, off=off, time=times)


def summary(table: pd.DataFrame, by: str) -> pd.DataFrame:
    """By a column of `prepared` rows and accuracy: answers, those whose error is larger than asked with the
    bound of their rate, those of them that are so by more than the reference's own error, estimates, times.
    """
    both, found = pd.concat((table, table.assign(**{by: "all"}))), []
    for (group, asked), part in both.groupby([by, "asked"], sort=False):
        answers = part[part.answered]
        failures, count = len(failing(answers)), len(answers)
        certain = int((answers.true - answers.own > answers.asked).sum())
        ratios, times = answers.estimated / answers.true, answers.time.dropna()
        timed = answers.loc[times.index, ["seconds", "cheapest"]].sum()
        whole = timed.seconds / timed.cheapest if len(times) else math.nan
        found.append((
            *(group, asked, len(part), len(part) - count, failures, upper_bound(failures, count), certain),
            *(ratios.median(), times.median(), times.quantile(0.9), whole),
        ))  # fmt: skip
    return pd.DataFrame(found, columns=[by, *HEADS])


def short(value: float) -> str:
    """Two digits; small numbers with a power of ten, as accuracies are written."""
    if math.isinf(value):
        return "infinite"
    if value == 0.0 or not abs(value) <= 0.01:
        return template.significant(value)
    digits, power = f"{value:.1e}".split("e")
    return f"{digits.removesuffix('.0')}e{int(power)}"


def listed(words: Iterable[object]) -> str:
    """Words with commas and an "and"."""
    *first, last = map(str, words)
    return f"{', '.join(first)} and {last}" if first else last


def at(values: Mapping[float, float]) -> str:
    """Values at their accuracies, "2.4 at 1e-2 and 3 at 1e-3"; none of those that are not known."""
    known = [f"{short(value)} at {short(asked)}" for asked, value in values.items() if not math.isnan(value)]
    return listed(known) if known else ""


def accuracies(rows: pd.DataFrame) -> list[float]:
    """Those asked for, the coarsest first."""
    return sorted(rows.asked.unique(), reverse=True)


def figures(rows: pd.DataFrame, coils: str = "") -> pd.DataFrame:
    """The `summary` of all rows, or of those whose coils do so, by accuracy."""
    found = summary(rows[rows.coils_do == coils] if coils else rows, "coils_do")
    return found[found.coils_do == "all"].set_index("asked").sort_index(ascending=False)


def springs(rows: pd.DataFrame, coils: str = "") -> pd.DataFrame:
    """One row of each spring, or of those whose coils do so."""
    found = rows.drop_duplicates(SPRING)
    return found[found.coils_do == coils] if coils else found


def answers(rows: pd.DataFrame, coils: str = "", asked: float | None = None) -> pd.DataFrame:
    """Rows that are no refusals, or those of them whose coils do so, at one accuracy."""
    found = rows[rows.answered & (rows.coils_do == (coils or rows.coils_do))]
    return found if asked is None else found[found.asked == asked]


def failing(rows: pd.DataFrame) -> pd.DataFrame:
    """Answers that are off by more than asked."""
    return rows[rows.off > 1.0]


def slowest(rows: pd.DataFrame, asked: float) -> tuple[str, float]:
    """What those coils do whose answers take longest in the median, and the time."""
    times = answers(rows, asked=asked).groupby("coils_do").time.median()
    return str(times.idxmax()), float(times.max())


def for_most(values: pd.Series) -> float:
    """What `MOST` of the values do not exceed, one of them."""
    return float(values.quantile(MOST, interpolation="higher"))


def absent(rows: pd.DataFrame) -> list[str]:
    """Contacts of wires that no spring of those whose coils touch has."""
    names = {"wires coulomb": "wires with friction", "wires none": "sticking wires"}
    found = set(rows.contact[rows.closed > 0])
    return [name for contact, name in names.items() if contact not in found]


FUNCTIONS = (
    *(short, listed, at, accuracies, figures, springs, answers),
    *(failing, slowest, for_most, absent, counted),
)
WORDS = template.template(Path(__file__).with_name("requestedpage.md"), FUNCTIONS)
WORDS.globals.update(coils=COILS, wires=WIRES, rate=RATE, most=MOST, seen=SEEN)
WORDS.globals.update(sections=MOST_SECTIONS, confidence=CONFIDENCE, infinite=math.inf, study=requestedruns)


def page(data: pd.DataFrame) -> str:
    """The page of the rows."""
    rows = prepared(data)
    tables = {"coils": table(rows, "coils_do", COILS), "kinds": table(rows, "kind", rows.kind.unique())}
    return template.page(WORDS, f=rows, tables=tables, worst=worst(rows))


def table(rows: pd.DataFrame, by: str, order: Iterable[str]) -> Table:
    """The `summary` as the page shows it."""
    found = summary(rows.sort_values("asked", ascending=False, kind="stable"), by)
    place = {name: place for place, name in enumerate((*order, "all"))}
    found = found.sort_values(by, key=lambda names: names.map(place), kind="stable")
    found["bound"] *= 100.0
    found[by] = found[by].where(~found[by].duplicated(), "")
    formats = dict.fromkeys(("asked", "bound", "ratio", "time", "time_90", "time_all"), short)
    heads = HEADS | {"coils_do": "coils"}
    return frame_table(found.rename(columns=heads), {heads[name]: form for name, form in formats.items()})


def worst(rows: pd.DataFrame) -> Table:
    """The answers whose error is the largest multiple of that asked for."""
    heads = {name: name for name in SPRING} | {"coils_do": "coils", "asked": "accuracy", "true": "error"}
    heads |= {"off": "over that asked for", "estimated": "estimate", "own": "reference's own"}
    found = rows[rows.answered].nlargest(WORST, "off")[list(heads)].rename(columns=heads)
    return frame_table(found, dict.fromkeys(list(heads.values())[4:], short))
