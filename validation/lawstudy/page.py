"""The page of a law: sentences, tables and the figure, all views of the study's rows."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from equivbeam.laws.userlaw import UserLaw
from validation.campaign.verdict import CLASSES as OUTCOMES
from validation.campaign.verdict import CONFIRMED, UNEXPLAINED
from validation.lawstudy.place import BUILT_IN, MESHES
from validation.lawstudy.springs import BAD, LAW, breakdown
from validation.study.document import Block, Bullets, Heading, Picture, Table, Text, to_markdown
from validation.study.frames import frame_table, view
from validation.study.plots import png
from validation.study.style import BLUE, DOUBLE, LIGHT_RED, NAVY, RC, RED
from validation.verification.randompage import CLASSES, cell, number
from validation.verification.randomsprings import COMPONENTS

NAME = "law"
LAWS = (*BUILT_IN, LAW)
FEWEST = 5  # springs of a kind, below which it is not named
GREEN = "#2e8b57"
LOOKS: dict[str, dict[str, Any]] = {
    "haringx": {"color": BLUE, "marker": "o", "label": "haringx"},
    "helix": {"color": NAVY, "marker": "D", "label": "helix"},
    LAW: {"color": GREEN, "marker": "*", "markersize": 9.0, "label": "this law"},
    "straight 40": {"color": LIGHT_RED, "marker": "s", "label": "wire, straight 40 (paper's mesh)"},
    "curved 4": {"color": RED, "marker": "v", "label": "wire, curved 4"},
    "curved 8": {"color": RED, "marker": "^", "label": "wire, curved 8"},
}


def files(law: UserLaw, data: dict[str, pd.DataFrame]) -> tuple[dict[str, bytes], list[str]]:
    """The page and its figure by file name, and the summary."""
    summary = [make(data) for make in SENTENCES]
    looks: Any = RC
    with matplotlib.rc_context(looks):
        picture = png(draw(data["place"]))
    text = to_markdown(blocks(law, data, summary))
    return {f"{NAME}.md": text.encode(), f"{NAME}.png": picture}, summary


def blocks(law: UserLaw, data: dict[str, pd.DataFrame], summary: list[str]) -> list[Any]:
    """The page."""
    source = law.source[1].rstrip() if law.source else ""
    code = [Heading(2, "The law"), Text(f"```python\n{source}\n```")]
    return [
        Heading(1, f"Study of the law {law.name}"),
        Text(
            "Errors are against the wire model, in per cent of its peak. `haringx` is the law of the paper, "
            "`helix` that of this project. The numbers are in `law.csv`."
        ),
        Bullets(tuple(summary)),
        *code,
        Heading(2, "Paper's four cases"),
        Text("Largest error of UX, UY and ROTZ, and of each, %; with the scene's sliding."),
        _cases(data["cases"]),
        Heading(2, "Random springs"),
        Text(f"Error of the tip vector: median / 95th percentile (springs), %, of {_names()}."),
        *[_kinds(data["springs"], name) for name in CLASSES],
        Text("Each component where pairs close, likewise:"),
        _components(data["springs"]),
        Heading(2, "What breaks first"),
        Text(f"Springs off by more than {BAD:g} %, and those whose path ends before the wire model's."),
        frame_table(_broken(data["springs"])),
        Text("How far the middle half coil of a spring can be moved before its energy fails:"),
        view(data["half coil"], {"spring": lambda r: r.spring, "direction": lambda r: r.direction,
             "until": lambda r: f"{r.share:.3g} {r.unit}", "there it": lambda r: r.what}),
        Heading(2, "Error and time"),
        Picture(f"{NAME}.png", "Error of the load curve against CPU time, 50 steps, kernels warm."),
        _place(data["place"]),
        Heading(2, "Stability"),
        Text(
            "Sampled scenes of the stability campaign with this law. The verifier differentiates the energy "
            "by differences of its own."
        ),
        *_stability(data["stability"]),
        Heading(2, "Limits"),
        frame_table(
            data["limits"].assign(off=_off(data["limits"])),
            dict.fromkeys(("found", "formula", "haringx"), "{:.5g}") | {"off": "{:+.2f} %"},
        ),
        Heading(2, "Derivatives"),
        Text("Largest deviation from differences of the plain function, over the stiffness at rest."),
        frame_table(data["derivatives"], {"deviation": "{:.1e}"}),
    ]  # fmt: skip


def _names() -> str:
    return ", ".join(f"`{name}`" for name in BUILT_IN) + " and this law"


def _cases(data: pd.DataFrame) -> Table:
    def each(name: str) -> Any:
        def text(row: Any) -> str:
            parts = (getattr(row, f"{name}_{component}", np.nan) for component in COMPONENTS)
            ended = getattr(row, f"{name}_outcome") != "completed"
            detail = ", ".join(f"{part:.2f}" for part in parts if not np.isnan(part))
            return f"{getattr(row, f'{name}_error'):.2f} ({detail}){' ends early' if ended else ''}"

        return text

    return view(data, {"case": lambda row: row.case} | {name: each(name) for name in LAWS})


def _kinds(data: pd.DataFrame, closing: str) -> Table:
    here = data[data["closing"] == closing]
    both = pd.concat((here, here.assign(kind="all")))
    columns = {f"{law}_vector": law for law in LAWS}
    cells = both.groupby("kind", sort=False)[list(columns)].agg(cell).rename(columns=columns)
    return frame_table(cells.rename_axis(closing).reset_index())


def _components(data: pd.DataFrame) -> Table:
    closed = data[data["closed"] > 0]
    lines = [(name.upper(), *(cell(closed[f"{law}_{name}"]) for law in LAWS)) for name in COMPONENTS]
    return Table(("component", *LAWS), tuple(lines))


def _broken(data: pd.DataFrame) -> pd.DataFrame:
    table = breakdown(data)
    titles = {"off": f"above {BAD:g} %", "ends": "ends early"}
    return (
        table[["kind", "contact", "springs", "off", "ends"]]
        .rename(columns=titles)
        .astype({"springs": int, **dict.fromkeys(titles.values(), int)})
    )


def _place(data: pd.DataFrame) -> Table:
    cells = data.assign(text=[f"{row.error:.2g} %, {row.ms:.3g} ms" for row in data.itertuples()])
    wide = cells.pivot(index="scene", columns="series", values="text")[[*LAWS, *MESHES]]
    return frame_table(wide.reindex(data["scene"].unique()).reset_index())


def _stability(data: pd.DataFrame) -> list[Block]:
    counts = data["class"].value_counts().reindex(OUTCOMES, fill_value=0)
    found: list[Block] = [Table(("class", "scenes"), tuple((name, str(counts[name])) for name in OUTCOMES))]
    bad = data[data["class"] == UNEXPLAINED]
    if len(bad):
        found.append(Bullets(tuple(f"{row.id}: {row.reason}" for row in bad.head(10).itertuples())))
    return found


def draw(data: pd.DataFrame) -> Figure:
    """A panel for each spring: error over CPU time of the laws and of some meshes of the wire model."""
    scenes = data["scene"].unique()
    figure = Figure(figsize=(DOUBLE, 4.2), layout="constrained")
    grid = figure.subplots(2, -(-len(scenes) // 2), sharex=True, sharey=True, squeeze=False)
    for axes, scene in zip(grid.flat, scenes, strict=False):
        for row in data[data["scene"] == scene].itertuples():
            axes.plot(row.ms, row.error, linestyle="none", **LOOKS[row.series])
        axes.set(xscale="log", yscale="log", title=scene)
    for axes in grid[-1]:
        axes.set_xlabel("CPU time (ms)")
    for axes in grid[:, 0]:
        axes.set_ylabel("error of the curve (%)")
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _off(limits: pd.DataFrame) -> pd.Series:
    """Difference from the closed form, or from haringx where there is none, per cent."""
    target = limits["formula"].astype(float).fillna(limits["haringx"].astype(float))
    return 100.0 * (limits["found"].astype(float) / target - 1.0)


def _cases_sentence(data: dict[str, pd.DataFrame]) -> str:
    cases = data["cases"]
    words = (f"{', '.join(f'{error:.2f}' for error in cases[f'{law}_error'])} % ({law})" for law in BUILT_IN)
    mine = ", ".join(f"{row.law_error:.2f} % ({row.case})" for row in cases.itertuples())
    return f"On the paper's cases the law is off by {mine}; the built-in laws by {' and '.join(words)}."


def _springs_sentence(data: dict[str, pd.DataFrame]) -> str:
    parts = []
    for closing in (CLASSES[0], CLASSES[-1]):
        rows = data["springs"].loc[data["springs"]["closing"] == closing]
        words = [
            f"{number(rows[f'{law}_vector'].median())} / {number(rows[f'{law}_vector'].quantile(0.95))}"
            for law in (LAW, *BUILT_IN)
        ]
        where = "without contact" if closing == CLASSES[0] else f"where {closing}"
        parts.append(f"{where} by {words[0]} % (haringx {words[1]}, helix {words[2]})")
    return (
        f"On {len(data['springs'])} random springs its tip is off, in the median and at the 95th percentile, "
        f"{' and '.join(parts)}."
    )


def _gain_sentence(data: dict[str, pd.DataFrame]) -> str:
    springs = data["springs"]
    rows = springs[springs["closing"] == CLASSES[0]]
    mine, haringx, helix = (rows[f"{law}_vector"].median() for law in (LAW, *BUILT_IN))
    share = (haringx - mine) / (haringx - helix)
    better = {law: (springs[f"{LAW}_vector"] < springs[f"{law}_vector"]).mean() for law in BUILT_IN}
    if abs(share) < 0.005:
        start = "Without contact its median error is that of haringx"
    elif share < 0.0:
        start = "Without contact its median error is larger than that of haringx"
    elif share >= 1.0:
        start = "Without contact its median error is below that of helix"
    else:
        start = (
            f"Without contact it takes away {100.0 * share:.0f} % of what haringx is worse than helix in the "
            "median: helix has still the smaller error"
        )
    return (
        f"{start}; on single springs it is nearer than haringx on {100 * better['haringx']:.0f} % and nearer "
        f"than helix on {100 * better['helix']:.0f} %."
    )


def _broken_sentence(data: dict[str, pd.DataFrame]) -> str:
    table = breakdown(data["springs"])
    many = table[table["springs"] >= FEWEST]
    table = many if len(many) else table
    table = table.assign(share=table["broken"] / table["springs"])
    halves = data["half coil"]
    first = halves[halves["what"] != "holds"]
    coil = (
        f"a half coil of {first.iloc[0]['spring']} that is {first.iloc[0]['direction']} by "
        f"{first.iloc[0]['share']:.2g} {first.iloc[0]['unit']} {first.iloc[0]['what']}"
        if len(first)
        else "no half coil of the paper's springs fails as far as it was moved"
    )
    if table["broken"].sum() == 0:
        return f"On no kind of load the tip is off by more than {BAD:g} %; {coil}."
    worst = table.loc[table["share"].idxmax()]
    beside = {law: breakdown(data["springs"], law).loc[worst.name, "broken"] for law in BUILT_IN}
    others = ", ".join(f"{law} {count:.0f}" for law, count in beside.items())
    return (
        f"What breaks first: {worst['kind']}, {worst['contact']}, where {worst['broken']:.0f} of "
        f"{worst['springs']:.0f} springs are off by more than {BAD:g} % or end early ({others}); {coil}."
    )


def _time_sentence(data: dict[str, pd.DataFrame]) -> str:
    ratios = data["place"].loc[data["place"]["series"] == LAW, "ratio"]
    return (
        f"It takes {ratios.median():.2f} times the time of haringx (median of {len(ratios)} springs, "
        f"{ratios.max():.2f} at most)."
    )


def _stability_sentence(data: dict[str, pd.DataFrame]) -> str:
    classes = data["stability"]["class"]
    bad = int((classes == UNEXPLAINED).sum())
    words = "every outcome is explained" if bad == 0 else f"{bad} outcomes are not explained"
    critical = int((classes == CONFIRMED).sum())
    return f"Of {len(classes)} sampled scenes {words}; {critical} end at a confirmed critical point."


def _limits_sentence(data: dict[str, pd.DataFrame]) -> str:
    limits = data["limits"].assign(off=_off(data["limits"]).abs())
    rate = limits[limits["what"].str.startswith("axial rate")]
    column = limits[~limits["what"].str.startswith("axial rate") & limits["off"].notna()]
    worst = data["derivatives"].set_index("what")["deviation"].groupby(level=0).max()
    return (
        f"Its rate at rest is within {rate['off'].max():.2g} % of the textbook's, its column within "
        f"{column['off'].max():.2g} % of Haringx's; its derivatives agree with differences to "
        f"{worst['gradient']:.0e} and {worst['Hessian']:.0e}."
    )


SENTENCES = (
    _cases_sentence,
    _springs_sentence,
    _gain_sentence,
    _broken_sentence,
    _time_sentence,
    _stability_sentence,
    _limits_sentence,
)
