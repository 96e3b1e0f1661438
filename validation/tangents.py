"""The paper's matrix and the exact tangent compared, as a page: ``python -m validation.tangents``."""

from __future__ import annotations

import sys
from pathlib import Path
from statistics import median

import equivbeam
from coilspring import EquilibriumNotFound, EquilibriumPath, Scene, load_scene
from validation.output import write_text

PAGE = Path("docs/tangents.md")
CASES = ("spring-a", "spring-a-no-contact", "spring-b", "spring-b-no-contact")
TANGENTS = ("exact", "paper", "paper-printed")
STEPS = (1, 5, 50, 200)
PENALTIES = (1e3, 1e4, 1e5, 1e6, 1e7)
ROUNDS = 5
HEAD = """# Tangents of the equivalent beam

Written by `python -m validation.tangents`; every number is measured there.

- *exact*: the Hessian of the energy, with a predictor along the path.
- *paper*: the matrix of the paper's section 2.3 with Phi = 12 Kfl/(Ksh L^2), started from the last state.
- *paper-printed*: the same with Phi = Kfl/(Ksh L^2), as printed.

All three have the exact contact matrix, the same energy line search, substeps and stop test; they find the
same equilibria. The paper's matrix converges linearly, and its pivots say nothing of stability. Iterations
are factorisations, rejected attempts included; times are medians of rounds in which the tangents take turns,
the ratio is formed within each round.
"""


def follow(scene: Scene, tangent: str, steps: int) -> EquilibriumPath:
    """The path as far as it goes."""
    try:
        return equivbeam.solve(scene, tangent=tangent, steps=steps)
    except EquilibriumNotFound as found:
        return found.path


def by_case() -> str:
    """Iterations and time of 50 steps; times are medians of rounds in which the tangents take turns."""
    lines = [
        "\n## Fifty steps\n",
        "| case | tangent | iterations | a step, most | CPU, ms | over exact |",
        "|---|---|---|---|---|---|",
    ]
    for case in CASES:
        scene = load_scene(case)
        paths = [[follow(scene, tangent, 50) for tangent in TANGENTS] for _ in range(ROUNDS + 1)][1:]
        for i, tangent in enumerate(TANGENTS):
            path = paths[0][i]
            ratio = median(row[i].solve_seconds / row[0].solve_seconds for row in paths)
            time = 1e3 * median(row[i].solve_seconds for row in paths)
            cells = (
                case,
                tangent,
                path.total_iterations,
                path.iterations.max(),
                f"{time:.2f}",
                f"{ratio:.1f}",
            )
            lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines) + "\n"


def by_steps() -> str:
    """Outcome and iterations over steps and penalties."""
    lines = [
        "\n## Where each fails\n",
        "Iterations to full load, or in bold what happened instead and when. What helps the paper's "
        "matrix over stiff contact is the line search and the substeps, which all three share.\n",
        "| case | penalty, N/mm | steps | " + " | ".join(TANGENTS) + " |",
        "|---|---|---|---|---|---|",
    ]
    for case in ("spring-a", "spring-b"):
        for penalty in PENALTIES:
            for steps in STEPS:
                scene = load_scene(case).with_penalty(penalty)
                cells = [told(follow(scene, tangent, steps)) for tangent in TANGENTS]
                lines.append(f"| {case} | {penalty:.0e} | {steps} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def told(path: EquilibriumPath) -> str:
    """Iterations of a completed path, or its outcome."""
    if path.outcome == "completed":
        return str(path.total_iterations)
    last = path.times[-1] if len(path.times) else 0.0
    return f"**{path.outcome.replace('_', ' ')}** at {path.critical_time or last:.3f}"


if __name__ == "__main__":
    write_text(PAGE, HEAD + by_case() + by_steps())
    sys.exit(0)
