"""The paper's matrix and the exact tangent compared: ``python -m validation.verification.tangents``."""

from itertools import product
from pathlib import Path

import pandas as pd

import equivbeam
from coilspring import CATALOGUE, EquilibriumPath, Scene, load_scene
from validation.study import template
from validation.study.files import write_facts, write_text
from validation.study.frames import frame_table
from validation.study.machine import machine
from validation.study.partialsolve import partial_path
from validation.study.timing import interleaved

PAGE, RECORD = Path("docs/tangents.md"), Path("reports/tangents")
TANGENTS = ("exact", "paper", "paper-printed")
STEPS = (1, 5, 50, 200)
PENALTIES = (1e3, 1e4, 1e5, 1e6, 1e7)
ROUNDS = 5
WORDS = template.template(Path(__file__).with_name("tangents.md"))


def by_case() -> pd.DataFrame:
    """Iterations and time of 50 steps; times are medians of rounds in which the tangents take turns."""
    rows = []
    for case in CATALOGUE:
        scene = load_scene(case)
        runs = {
            name: lambda scene=scene, name=name: follow(scene, name, 50).solve_seconds for name in TANGENTS
        }
        times = pd.DataFrame(interleaved(runs, range(ROUNDS)))
        ratios = times.div(times["exact"], axis=0).median()
        for tangent in TANGENTS:
            path = follow(scene, tangent, 50)
            numbers = {"iterations": path.total_iterations, "a step, most": path.iterations.max()}
            numbers |= {"CPU, ms": 1e3 * times[tangent].median(), "over exact": ratios[tangent]}
            rows.append({"case": case, "tangent": tangent, **numbers})
    return pd.DataFrame(rows)


def by_steps() -> pd.DataFrame:
    """Outcome and iterations over steps and penalties."""
    rows = []
    for case, penalty, steps in product(("spring-a", "spring-b"), PENALTIES, STEPS):
        scene = load_scene(case).with_penalty(penalty)
        cells = {tangent: result(follow(scene, tangent, steps)) for tangent in TANGENTS}
        rows.append({"case": case, "penalty, N/mm": f"{penalty:.0e}", "steps": steps, **cells})
    return pd.DataFrame(rows)


def follow(scene: Scene, tangent: str, steps: int) -> EquilibriumPath:
    """Path of the equivalent beam with a tangent, as far as it goes."""
    return partial_path(equivbeam.solve, scene, tangent=tangent, steps=steps)


def result(path: EquilibriumPath) -> str:
    """Iterations of a completed path, or its outcome."""
    if path.outcome == "completed":
        return str(path.total_iterations)
    return f"**{path.outcome.replace('_', ' ')}** at {path.critical_time or path.times.max(initial=0.0):.3f}"


def ends(steps: pd.DataFrame) -> dict[str, int]:
    """How many runs over steps and penalties there are, and how many of them end before full load."""
    cells = steps[[*TANGENTS]].to_numpy().ravel()
    return {"runs": len(cells), "early": sum(cell.startswith("**") for cell in cells)}


def page(fifty: pd.DataFrame, steps: pd.DataFrame) -> str:
    """The page, a view of the runs."""
    table = frame_table(fifty, {"CPU, ms": "{:.2f}", "over exact": "{:.1f}"})
    return template.page(WORDS, f=ends(steps), fifty=table, steps=frame_table(steps), on=machine())


if __name__ == "__main__":
    fifty = by_case()
    write_text(PAGE, page(fifty, by_steps()))
    write_facts({f"{row.case}.{row.tangent}": row.iterations for row in fifty.itertuples()}, RECORD)
