"""How far our curves could be from the authors' because of what the paper leaves open.

One input at a time takes its other values (`validation.sensitivity.inputs`) in both models, on the paper's
four cases.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from coilspring import CATALOGUE
from coilspring.errors import require_names
from validation.sensitivity import page, tornado
from validation.sensitivity.changes import changes, write_csv
from validation.study.cases import CASES, make_ready
from validation.study.output import prepare
from validation.study.provenance import write_provenance


def sensitivity(
    out: str | Path, only: Sequence[str] | None = None, progress: Callable[[str], None] = lambda line: None
) -> tuple[pd.DataFrame, ...]:
    """Vary what the paper leaves open; write ``sensitivity.csv``, ``.md`` and the figure to `out`.

    Parameters
    ----------
    out : folder, made where missing.
    only : names of the paper's cases; None for all.
    progress : called with one line on what is being done.

    Raises
    ------
    InputError : an unknown name.

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
    studies = tuple(changes(case, progress) for case in CASES if only is None or case.name in only)
    write_csv(studies, out)
    progress("drawing")
    tornado.write(studies, out)
    page.write(studies, out)
    write_provenance("coilcheck sensitivity" + (f" --only {','.join(only)}" if only else ""), out)
    return studies
