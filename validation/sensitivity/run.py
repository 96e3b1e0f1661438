"""How far our curves could be from the authors' because of what the paper leaves open.

One input at a time takes its other values (`validation.sensitivity.inputs`) in both models, on the paper's
four cases; of a user's scenes, about their own (`validation.sensitivity.inputs.inputs_of`).
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from coilspring import CATALOGUE, Scene
from coilspring.errors import require_names
from validation.sensitivity import changes, page, tornado
from validation.sensitivity.changes import Study
from validation.sensitivity.inputs import INPUTS, inputs_of
from validation.study.cases import CASES
from validation.study.files import prepare
from validation.study.partialsolve import EndedEarly
from validation.study.paths import make_ready
from validation.study.provenance import write_provenance
from validation.study.store import Store, default_folder


def sensitivity(
    out: str | Path,
    only: Sequence[str] | None = None,
    progress: Callable[[str], None] = lambda line: None,
    scenes: Mapping[str, Scene] | None = None,
) -> tuple[Study, ...]:
    """Vary what the paper leaves open, or the inputs of a user's scenes; the changes of each.

    Writes ``sensitivity.csv``, ``.md`` and the figure to `out`.

    Parameters
    ----------
    only : names of the paper's cases; None for all.
    scenes : a user's, by their names, in the place of the paper's cases.

    Raises
    ------
    InputError : an unknown name; a scene that no model represents.
    EndedEarly : no scene has a path to full load; one beside others is left out, see `changes.ended_early`.
    """
    require_names("only", only or (), CATALOGUE)
    out = Path(out)
    prepare(out)
    progress("making the kernels ready")
    make_ready()
    cases = {case.name: case.scene for case in CASES if only is None or case.name in only}
    studies: list[Study] = []
    store = Store(default_folder())
    with store.kept_if_interrupted():
        for name, scene in (scenes or cases).items():
            inputs = inputs_of(scene) if scenes else INPUTS
            studies.append(changes.changes(name, scene, inputs, progress, store))
    if not (done := [study for study in studies if not study.data.empty]):
        raise EndedEarly(changes.ended_early(studies))
    progress("drawing")
    changes.write_csv(done, out)
    tornado.write(done, out)
    page.write(studies, out, own=bool(scenes))
    options = [*(scenes or ()), *(["--only", ",".join(only)] if only else [])]
    write_provenance(" ".join(["coilcheck sensitivity", *options]), out)
    return tuple(studies)
