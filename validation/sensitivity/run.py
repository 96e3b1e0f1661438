"""How far our curves could be from the authors' because of what the paper leaves open.

One input at a time takes its other values (`validation.sensitivity.inputs`) in both models, on the paper's
four cases; of a user's scenes, about their own (`validation.sensitivity.inputs.inputs_of`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from coilspring import CATALOGUE, Scene
from coilspring.errors import require_names
from validation.sensitivity import page, tornado
from validation.sensitivity.changes import Study, changes, write_csv
from validation.sensitivity.inputs import INPUTS, inputs_of
from validation.study.cases import CASES, make_ready
from validation.study.output import prepare
from validation.study.provenance import write_provenance


def sensitivity(
    out: str | Path,
    only: Sequence[str] | None = None,
    progress: Callable[[str], None] = lambda line: None,
    scenes: Mapping[str, Scene] | None = None,
) -> tuple[Study, ...]:
    """Vary what the paper leaves open, or the inputs of a user's scenes.

    Writes ``sensitivity.csv``, ``.md`` and the figure to `out`.

    Parameters
    ----------
    out : folder, made where missing.
    only : names of the paper's cases; None for all.
    progress : called with one line on what is being done.
    scenes : a user's, by their names, in the place of the paper's cases.

    Raises
    ------
    InputError : an unknown name; a scene of which no model has a load curve.

    Returns
    -------
    tuple
        The changes of each case, see `validation.sensitivity.changes`.
    """
    require_names("only", only or (), CATALOGUE)
    out = Path(out)
    prepare(out)
    progress("making the kernels ready")
    make_ready()
    cases = {case.name: case.scene for case in CASES if only is None or case.name in only}
    studies: list[Study] = []
    for name, scene in (scenes or cases).items():
        studies.append(changes(name, scene, inputs_of(scene) if scenes else INPUTS, progress))
        write_csv(studies, out)
    progress("drawing")
    tornado.write(studies, out)
    page.write(studies, out, own=bool(scenes))
    options = [*(scenes or ()), *(["--only", ",".join(only)] if only else [])]
    write_provenance(" ".join(["coilcheck sensitivity", *options]), out)
    return tuple(studies)
