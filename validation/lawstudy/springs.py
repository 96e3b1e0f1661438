"""The law on the random springs: the wire model's curves are stored once for all laws."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from equivbeam.laws.userlaw import UserLaw
from validation.study.metrics import answered
from validation.verification.randompage import CLASSES, classified
from validation.verification.randomscenes import KINDS, population
from validation.verification.randomsprings import COMPONENTS, LAWS, Curve, closed, law_row, reference

LAW = "law"  # the user's, among the names of laws
BAD = 5.0  # per cent of the tip vector, from which on a law counts as broken


class Extent(NamedTuple):
    """How many springs of each kind, from which seeds."""

    seeds: tuple[int, ...] = (0, 1)
    each: int = 40


def wire_curves(seed: int, kind: str, each: int) -> list[dict[str, Any]]:
    """What the springs of a kind are, the wire model's curves, and both built-in laws' errors."""
    found = []
    for drawn in population(seed, each, (kind,)):
        scene = drawn.scene
        wire = reference(scene)
        row: dict[str, Any] = {"seed": seed, "kind": kind, "number": drawn.number, "shape": drawn.shape}
        row |= {"contact": scene.contact.enabled, "closed": closed(wire)}
        row |= {"wire": wire.outcome, "times": wire.times.tolist()}
        row["answers"] = {name: values.tolist() for name, values in answered(wire).items()}
        for law in LAWS:
            row |= law_row(law, law, scene, Curve.of(wire))
        found.append(row)
    return found


def law_errors(law: UserLaw, rows: list[dict[str, Any]], each: int) -> list[dict[str, Any]]:
    """The rows of `wire_curves`, without the curves, with the errors of a law."""
    found = []
    springs = population(rows[0]["seed"], each, (rows[0]["kind"],)) if rows else ()
    for row, drawn in zip(rows, springs, strict=True):
        answers = {name: np.array(values) for name, values in row["answers"].items()}
        wire = Curve(drawn.scene, np.array(row["times"]), answers)
        plain = {name: value for name, value in row.items() if name not in ("times", "answers")}
        found.append(plain | law_row(LAW, law, drawn.scene, wire))
    return found


def frame(rows: list[dict[str, Any]]) -> pd.DataFrame:
    """The rows with their class of contact."""
    data = pd.DataFrame(rows)
    names = [f"{law}_{name}" for law in (*LAWS, LAW) for name in ("vector", *COMPONENTS)]
    return classified(data.astype(dict.fromkeys(names, float)))


def breakdown(data: pd.DataFrame, law: str = LAW) -> pd.DataFrame:
    """For each kind and class: springs, and those on which a law is broken, by what.

    Broken: the error of the tip vector is above `BAD`, or the law's path ends before the wire model's does.
    """
    ends = (data[law] != "completed") & (data["wire"] == "completed")
    off = data[f"{law}_vector"] > BAD
    known = data.assign(ends=ends, off=off, broken=ends | off)
    table = known.groupby(["kind", "closing"])[["ends", "off", "broken"]].sum()
    table["springs"] = known.groupby(["kind", "closing"]).size()
    order = pd.MultiIndex.from_product(([kind.name for kind in KINDS], CLASSES))
    return table.reindex(order).dropna().rename_axis(["kind", "contact"]).reset_index()
