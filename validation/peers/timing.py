"""CPU time of the wire model and of OpenSees on one mesh: ``python -m validation.peers.timing``.

It writes the page and what findings are computed from. Exit code 1: the tips are not the same; 2: OpenSees is
missing, or a path ends early.
"""

import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pandas as pd

import wirefe
from coilspring import CATALOGUE, InputError, Scene
from coilspring.curves import COMPONENTS
from validation.peers.comparison import MISSING, opensees
from validation.peers.layout import PeerCurve
from validation.peers.page import FOLDER
from validation.study import template
from validation.study.files import write_facts, write_text
from validation.study.frames import view
from validation.study.machine import machine, versions
from validation.study.metrics import tip_deviation
from validation.study.partialsolve import EndedEarly, partial_path
from validation.study.timing import announced, interleaved, quartiles, spread

CODES = ("wirefe", "opensees")
SCENES = ("spring-a", "spring-a-no-contact", "spring-b-no-contact")
STEPS = 50  # of the paper
COUNTS = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, STEPS)
AGREEMENT = 0.002  # of the tip: between the codes, and of few steps with `STEPS`
ROUNDS = 5
WORDS = template.template(Path(__file__).with_name("timing.md"))
TIMES: dict[str, Callable[[Any], object]] = {
    "ratio": lambda row: spread(row, "ratio"),
    "scene": lambda row: row.scene,
    "steps chosen": lambda row: row.kind,
    "steps": lambda row: f"{row.wirefe_steps} / {row.opensees_steps}",
    "wirefe, ms": lambda row: spread(row, "wirefe_seconds", 1e3),
    "OpenSees, ms": lambda row: spread(row, "opensees_seconds", 1e3),
    "iterations": lambda row: f"{row.wirefe_iterations} / {row.opensees_iterations}",
    "tip difference, %": lambda row: f"{100.0 * row.difference:.4f}",
}
TIPS: dict[str, Callable[[Any], object]] = {
    "scene": lambda row: row.scene,
    "code": lambda row: row.code,
    "UX, mm": lambda row: f"{row.ux:.4f}",
    "UY, mm": lambda row: f"{row.uy:.4f}",
    "ROTZ, rad": lambda row: f"{row.rotz:.5f}",
}
Run = Callable[[int], PeerCurve]  # in so many steps


def runs_of(scene: Scene, peer: ModuleType) -> dict[str, Run]:
    """Each code on a scene; `peer` is `validation.peers.opensees`, which takes its steps undivided here."""

    def wire(steps: int) -> PeerCurve:
        path = partial_path(wirefe.solve, scene, steps=steps)
        return PeerCurve("wirefe", path.times, path.tips, path.solve_seconds, path.total_iterations)

    def beside(steps: int) -> PeerCurve:
        return peer.run(scene, steps, peer.tolerance(scene), halvings=0)

    return {"wirefe": wire, "opensees": beside}


def sufficient(run: Run, name: str) -> dict[int, PeerCurve]:
    """Curves of a code in the numbers of steps of `COUNTS` that give the tip of `STEPS`.

    Raises `EndedEarly`: it does not reach full load in those. This first run also makes what runs ready.
    """
    reference = run(STEPS)
    if len(reference.times) < STEPS:
        raise EndedEarly(f"{reference.code} did not reach full load on {name} in {STEPS} steps")
    curves = {steps: run(steps) for steps in COUNTS}
    whole = {steps: curve for steps, curve in curves.items() if len(curve.times) == steps}
    tip = reference.tips[-1]
    return {steps: curve for steps, curve in whole.items() if tip_deviation(curve.tips[-1], tip) <= AGREEMENT}


def timed(name: str, runs: Mapping[str, Run], rounds: Iterable[object]) -> pd.DataFrame:
    """A row for each choice of the two numbers of steps on a scene; all runs take turns in each round."""
    curves = {code: sufficient(run, name) for code, run in runs.items()}
    chosen = {
        "equal": dict.fromkeys(runs, STEPS),
        "fewest": {code: min(found) for code, found in curves.items()},
        "fastest": {code: min(found, key=lambda n: found[n].seconds) for code, found in curves.items()},
    }
    taken = {item for steps in chosen.values() for item in steps.items()}
    each = {(code, n): lambda code=code, n=n: runs[code](n).seconds for code, n in sorted(taken)}
    seconds, rows = interleaved(each, rounds), []
    for kind, steps in chosen.items():
        row: dict[str, Any] = {"scene": name, "kind": kind}
        for code, n in steps.items():
            row |= quartiles(f"{code}_seconds", seconds[code, n])
            row |= {f"{code}_steps": n, f"{code}_iterations": curves[code][n].iterations}
            row |= {f"{code}_tip": curves[code][n].tips[-1]}
        wire, peer = (seconds[code, steps[code]] for code in CODES)
        row |= quartiles("ratio", peer / wire)
        rows.append(row | {"difference": tip_deviation(row["opensees_tip"], row["wirefe_tip"])})
    return pd.DataFrame(rows)


def page(data: pd.DataFrame, tolerance: float) -> str:
    """The page as Markdown; `tolerance`: of OpenSees' energy test."""
    tips = [
        {"scene": row["scene"], "code": code} | dict(zip(COMPONENTS, row[f"{code}_tip"], strict=True))
        for row in data[data["kind"] == "equal"].to_dict("records")
        for code in CODES
    ]
    return template.page(
        WORDS,
        host=machine(),
        openseespy=versions("openseespy")["openseespy"],
        times=view(data, TIMES),
        tips=view(pd.DataFrame(tips), TIPS),
        rounds=ROUNDS,
        steps=STEPS,
        counts=", ".join(map(str, COUNTS)),
        tolerance=tolerance,
        agreement=AGREEMENT,
    )


def facts(data: pd.DataFrame) -> dict[str, object]:
    """The date, median ratios of the times, and the difference of the tips in equal steps, per cent."""
    found: dict[str, object] = {"opensees.made": machine()["date"]}
    for row in data.to_dict("records"):
        found[f"opensees.{row['scene']}.{row['kind']}"] = row["ratio"]
        if row["kind"] == "equal":
            found[f"opensees.{row['scene']}.difference"] = 100.0 * row["difference"]
    return found


def main(folder: Path = FOLDER) -> int:
    """Time both codes on all scenes, write page and facts, and return the exit code."""
    peer = opensees()
    if peer is None:
        raise InputError(MISSING)
    scenes = {name: runs_of(CATALOGUE[name](), peer) for name in SCENES}
    data = pd.concat(timed(name, runs, announced(ROUNDS, print, name)) for name, runs in scenes.items())
    write_facts(facts(data), folder)
    write_text(folder / "opensees.md", page(data, peer.TOLERANCE))
    return int((data["difference"] > AGREEMENT).any())


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (InputError, EndedEarly) as error:
        print(error, file=sys.stderr)
        sys.exit(2)
