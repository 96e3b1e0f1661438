"""How far our curves could be from the authors' because of what the paper leaves open.

One input at a time takes its other values (`validation.sensitivity.inputs`) in both models, on the paper's
four cases. A change is positive where the top moves farther than with our default, in per cent of the
default's peak, as `validation.study.metrics` has it; the size of an input is the largest of its changes at
any load.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from coilspring import CATALOGUE
from coilspring.errors import require_names
from validation.sensitivity import data, page, tornado
from validation.sensitivity.inputs import BEAM, INPUTS, MODELS, Variant
from validation.sensitivity.results import Change, Study
from validation.sensitivity.topheight import TipCurve, raised
from validation.study.cases import CASES, Case, PathStore
from validation.study.output import prepare
from validation.study.provenance import write_provenance
from validation.study.warmup import make_ready


def sensitivity(
    out: str | Path,
    only: Sequence[str] | None = None,
    progress: Callable[[str], None] = lambda line: None,
) -> tuple[Study, ...]:
    """Vary what the paper leaves open; write ``sensitivity.csv``, ``.md`` and the figure to `out`.

    Parameters
    ----------
    out : folder, made where missing.
    only : names of the paper's cases; None for all.
    progress : called with one line on what is being done.

    Raises
    ------
    InputError : an unknown name.
    """
    require_names("only", only or (), CATALOGUE)
    out = Path(out)
    prepare(out)
    progress("making the kernels ready")
    make_ready()
    studies = tuple(study(case, progress) for case in CASES if only is None or case.name in only)
    data.write(studies, out)
    progress("drawing")
    tornado.write(studies, out)
    page.write(studies, out)
    write_provenance("coilcheck sensitivity" + (f" --only {','.join(only)}" if only else ""), out)
    return studies


def study(case: Case, progress: Callable[[str], None]) -> Study:
    """Every value of every open input on one case."""
    store = PathStore(lambda line: None)
    bases = {model: _solved(store, model, Variant("", case.scene)) for model in MODELS}
    changes = []
    for item in INPUTS:
        progress(f"{case.title}: {item.title}")
        for model in MODELS:
            for variant in item.variants(case.scene, model):
                base = _solved(store, model, Variant("", case.scene, variant.base_options))
                changes.append(Change(item, model, variant.value, base, _solved(store, model, variant)))
    return Study(case, bases, tuple(changes))


def _solved(store: PathStore, model: str, variant: Variant) -> TipCurve:
    if variant.rise:
        return raised(variant.scene, model, variant.rise)
    solve = store.beam_as_far if model == BEAM else store.wire_as_far
    return TipCurve.of(solve(variant.scene, **variant.options))
