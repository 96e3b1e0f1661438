"""The paper's matrix and the exact tangent compared: ``python -m validation.verification.tangents``."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pandas as pd

import equivbeam
from coilspring import EquilibriumPath, Scene, load_scene
from validation.study.document import Block, Heading, Table, Text, to_markdown
from validation.study.output import write_facts, write_text
from validation.study.partialsolve import partial_path
from validation.study.timing import interleaved

PAGE, RECORD = Path("docs/tangents.md"), Path("reports/tangents")
CASES = ("spring-a", "spring-a-no-contact", "spring-b", "spring-b-no-contact")
TANGENTS = ("exact", "paper", "paper-printed")
STEPS = (1, 5, 50, 200)
PENALTIES = (1e3, 1e4, 1e5, 1e6, 1e7)
ROUNDS = 5
HEAD = """# Tangents of the equivalent beam

Written by `python -m validation.verification.tangents`; every number is measured there.

- *exact*: the Hessian of the energy, with a predictor along the path.
- *paper*: the matrix of the paper's section 2.3 with Phi = 12 Kfl/(Ksh L^2), started from the last state.
- *paper-printed*: the same with Phi = Kfl/(Ksh L^2), as printed.

All three have the exact contact matrix, the same energy line search, substeps and stop test; they find the
same equilibria. The paper's matrix converges linearly, and its pivots say nothing of stability. Iterations
are factorisations, rejected attempts included; times are medians of rounds in which the tangents take turns,
the ratio is formed within each round."""


def by_case() -> tuple[Heading, Table]:
    """Iterations and time of 50 steps; times are medians of rounds in which the tangents take turns."""
    rows = []
    for case in CASES:
        scene = load_scene(case)
        paths = {tangent: follow(scene, tangent, 50) for tangent in TANGENTS}
        runs = {name: partial(_seconds, scene, name) for name in TANGENTS}
        times = pd.DataFrame(interleaved(runs, range(ROUNDS)))
        ratios = times.div(times["exact"], axis=0).median()
        for tangent, path in paths.items():
            counts = str(path.total_iterations), str(path.iterations.max())
            time = 1e3 * times[tangent].median()
            rows.append((case, tangent, *counts, f"{time:.2f}", f"{ratios[tangent]:.1f}"))
    header = ("case", "tangent", "iterations", "a step, most", "CPU, ms", "over exact")
    return Heading(2, "Fifty steps"), Table(header, tuple(rows))


def _seconds(scene: Scene, tangent: str) -> float:
    return follow(scene, tangent, 50).solve_seconds


def by_steps() -> list[Block]:
    """Outcome and iterations over steps and penalties."""
    rows = []
    for case in ("spring-a", "spring-b"):
        for penalty in PENALTIES:
            for steps in STEPS:
                scene = load_scene(case).with_penalty(penalty)
                cells = [result(follow(scene, tangent, steps)) for tangent in TANGENTS]
                rows.append((case, f"{penalty:.0e}", str(steps), *cells))
    words = (
        "Iterations to full load, or in bold what happened instead and when. What helps the paper's "
        "matrix over stiff contact is the line search and the substeps, which all three share."
    )
    header = ("case", "penalty, N/mm", "steps", *TANGENTS)
    return [Heading(2, "Where each fails"), Text(words), Table(header, tuple(rows))]


def follow(scene: Scene, tangent: str, steps: int) -> EquilibriumPath:
    """Path of the equivalent beam with a tangent, as far as it goes."""
    return partial_path(equivbeam.solve, scene, tangent=tangent, steps=steps)


def result(path: EquilibriumPath) -> str:
    """Iterations of a completed path, or its outcome."""
    if path.outcome == "completed":
        return str(path.total_iterations)
    last = path.times[-1] if len(path.times) else 0.0
    return f"**{path.outcome.replace('_', ' ')}** at {path.critical_time or last:.3f}"


if __name__ == "__main__":
    heading, fifty = by_case()
    write_text(PAGE, to_markdown((Text(HEAD), heading, fifty, *by_steps())))
    write_facts({f"{case}.{tangent}": int(count) for case, tangent, count, *_ in fifty.rows}, RECORD)
