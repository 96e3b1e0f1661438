"""What the wire model's contact moves and costs: ``python -m validation.verification.contact``."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

import wirefe
from coilspring import Contact, EquilibriumPath, Load, Scene, load_scene, spring_a, spring_b
from coilspring.curves import COMPONENTS, moved
from validation.study import template
from validation.study.cases import turned
from validation.study.files import write_facts, write_text
from validation.study.metrics import tip_deviation
from validation.study.partialsolve import partial_path
from wirefe.contact.points import ContactArrays
from wirefe.results.shape import contact_centres

NONE = np.inf  # no sliding
CYCLE = Load(stages=((0.0, -80.0), (0.0, 0.0)), steps=100)  # of a progressive valve spring
SPRINGS: dict[str, Callable[[], Scene]] = {
    "A": spring_a,
    "B": spring_b,
    "cycle": lambda: replace(load_scene("examples/stages.toml"), load=CYCLE),
    "valve": lambda: replace(load_scene("examples/stages.toml"), load=Load((0.0, -80.0), steps=50)),
}
PAGE, RECORD = Path("docs/contact.md"), Path("reports/contact")
CATALOGUE = {"A": 0.0, "B": NONE}  # coefficients of the catalogue's springs
TOLERANCE = 1e-8  # of the follower's equilibria
LIKE, FORCE = 0.01, 100.0  # mm, N: penetration at which all exponents give one force
SLIDES = 1e-9  # N mm: less work is none
REPEATS = 3  # timed runs, of which the least counts
STEPS = (10, 50, 200)
KINDS = (("spheres", 4), ("spheres", 20), ("wires", 16), ("wires", 32), ("wires", 64))


@dataclass(frozen=True)
class Run:
    """One run: the spring, its coefficient of friction, contact pairs per turn, F = K depth^k, N/mm^k."""

    spring: str
    mu: float  # 0 for none, infinite for no sliding
    pairs: int = 4
    k: float = 1.0
    K: float = 1e4
    steps: int = 50
    geometry: str = "spheres"
    degrees: float = 0.0  # start phase
    elements: int = 0  # per turn, curved ones; 0 for the 40 straight ones of the paper

    @property
    def scene(self) -> Scene:
        """The scene that is solved."""
        sliding = {0.0: "free", NONE: "none"}.get(self.mu, "coulomb")
        friction = self.mu if sliding == "coulomb" else None
        contact = Contact(
            stiffness=self.K, exponent=self.k, sliding=sliding, friction=friction, geometry=self.geometry
        )
        return replace(turned(SPRINGS[self.spring](), self.degrees), contact=contact)

    def solved(self) -> EquilibriumPath:
        """Its path, as far as it goes."""
        mesh = {"element": "curved", "elements_per_turn": self.elements} if self.elements else {}
        steps = {} if self.spring == "cycle" else {"steps": self.steps}
        return partial_path(wirefe.solve, self.scene, pairs_per_turn=self.pairs, **steps, **mesh)


RUNS = {
    "pairs": [Run(name, mu, pairs) for name, mu in CATALOGUE.items() for pairs in (4, 8, 20, 40)],
    "exponents": [
        Run(name, mu, k=k, K=FORCE * LIKE**-k) for name, mu in CATALOGUE.items() for k in (1.0, 1.5, 2.0)
    ],
    "friction": [
        Run(name, mu, steps=steps)
        for name, mu, steps in product(CATALOGUE, (0.0, 0.05, 0.1, 0.3, 1.0, NONE), STEPS)
    ],
    "search": [
        Run(name, mu, pairs, K=K, steps=10, elements=pairs)
        for name, mu, K, pairs in (
            ("A", 0.0, 1e2, 40), ("A", 0.0, 3e1, 40), ("B", NONE, 1e2, 20), ("B", NONE, 1e2, 40),
            ("B", 0.0, 1e4, 4), ("B", 0.0, 1e4, 40), ("B", 0.0, 1e4, 80),
        )
    ],
    "geometry": [
        Run(name, mu, pairs, geometry=geometry)
        for name, mu, (geometry, pairs) in product(CATALOGUE, (0.0, 0.1, 0.2, 0.3, NONE), KINDS)
    ],
    "phases": [
        Run("A", 0.0, pairs, geometry=geometry, degrees=degrees)
        for degrees, (geometry, pairs) in product((0.0, 11.25, 22.5, 45.0), (*KINDS[:2], KINDS[3]))
    ],
    "cycles": [Run("cycle", 0.1, pairs, geometry=geometry) for geometry, pairs in KINDS],
    "forces": [
        Run(name, mu, pairs, geometry=geometry, elements=elements)
        for (name, mu), (geometry, pairs), elements in product(
            (("A", 0.0), ("B", NONE), ("valve", 0.1)), (("spheres", 4), ("wires", 32)), (4, 8, 16, 32, 64)
        )
    ],
}  # fmt: skip
Runs = Mapping[str, pd.DataFrame]


def measured(runs: Iterable[Run], repeats: int = 1) -> pd.DataFrame:
    """A row for each run; ``seconds`` is the least CPU time of the repeats."""
    rows = []
    for run in runs:
        paths = [run.solved() for _ in range(repeats)]
        seconds = min(path.solve_seconds for path in paths)
        rows.append(asdict(run) | measures(paths[0]) | {"seconds": seconds})
    return pd.DataFrame(rows)


def measures(path: EquilibriumPath) -> dict[str, Any]:
    """Numbers of a path at its last step; works, overlaps and the largest slip of all its steps."""
    (x, y), (fx, fy) = path.top[-1, :2], path.loads[-1]
    return dict(zip(COMPONENTS, path.tips[-1], strict=True)) | {
        "outcome": path.outcome.replace("_", " "),
        "critical time": path.critical_time,
        "overlap": path.max_overlap[-1],
        "penetration": path.max_penetration[-1],
        "force": path.contact_forces[-1].max(),
        "forces": path.contact_forces[-1].sum(),
        "factorisations": path.total_iterations,
        "pairs found": path.options["pairs_found"],
        "unlisted": unlisted(path),
        "work": float(path.friction.work[-1].sum()),
        "largest slip": path.friction.slip.max(),
        "last slip": path.friction.slip[-1].max(),
        "couple": couple(path),
        "moment": abs(float(x * fy - y * fx)),
    }


def difference(runs: pd.DataFrame, reference: pd.Series) -> np.ndarray:
    """Deviation of the runs' tips from that of a reference."""
    names = list(COMPONENTS)
    return tip_deviation(runs[names].to_numpy(float), reference[names].to_numpy(float))


def centres(path: EquilibriumPath, step: int) -> tuple[ContactArrays, np.ndarray]:
    """Contact arrays, and the centres of their spheres or stations at a stored step."""
    contact = path.shape.pair_law
    return contact, contact_centres(contact, path.states[step][None])[0]


def couple(path: EquilibriumPath) -> float:
    """Size of the sum of the couples g x f_t that the tangential forces leave at the last step, N mm."""
    contact, places = centres(path, -1)
    gap = places[contact.pairs[:, 1]] - places[contact.pairs[:, 0]]
    return float(np.linalg.norm(np.cross(gap, path.friction.force[-1]).sum(axis=0)))


def unlisted(path: EquilibriumPath) -> int:
    """Overlaps of spheres, over all stored states, that are no pair of the model."""
    count = 0
    for step in range(len(path.times)):
        contact, places = centres(path, step)
        low, high = cKDTree(places).query_pairs(contact.d, output_type="ndarray").T
        apart = (high - low > contact.near) & (contact.attached[low] != contact.attached[high])
        listed = np.isin(low * len(places) + high, contact.pairs @ [len(places), 1])
        count += int((apart & ~listed).sum())
    return count


def limit_point() -> dict[str, Any]:
    """Where frictionless Spring B goes at its limit point: the closed pair that moves most, and how far along
    the wire."""
    path = wirefe.trace(Run("B", 0.0).scene, points=160, element="curved", elements_per_turn=8)
    limit = int(np.argmax(np.diff(path.times) < 0.0))
    contact, before = centres(path, limit - 3)
    _, after = centres(path, limit + 1)
    lower, upper = contact.pairs.T
    motion = (after[upper] - after[lower]) - (before[upper] - before[lower])
    most = int(np.argmax(np.linalg.norm(motion, axis=1) * (path.gaps[limit + 1] < 0.0)))
    along = np.cross([0.0, 1.0, 0.0], after[lower[most]])
    share = abs(motion[most] @ along) / np.linalg.norm(along) / np.linalg.norm(motion[most])
    found = {"traced": path.options["pairs_found"], "limit": path.times[limit], "circ": 100.0 * share}
    return found | {"first": lower[most], "second": upper[most]}


def two_figures(share: float) -> str:
    """A share in percent, to two figures; 0 below a solver's tolerance."""
    return f"{template.significant(100.0 * share)} %" if share > TOLERANCE else "0"


def tip(run: Mapping[str, Any], components: int = 3) -> str:
    """Cells of the first components of a run's tip."""
    values = np.array([run[name] for name in COMPONENTS])
    texts = [f"{value:.4f}" if free else "0" for value, free in zip(values, moved(values[None]), strict=True)]
    return " | ".join(texts[:components])


def coefficient(mu: float) -> str:
    """A coefficient of friction, or that nothing slides."""
    return "no sliding" if mu == NONE else f"{mu:g}"


WORDS = template.template(Path(__file__).with_name("contact.md"), [two_figures, tip, coefficient, pd.notna])
WORDS.globals.update(
    force=FORCE, like=LIKE, steps=STEPS, least_work=SLIDES, d=spring_a().spring.wire_diameter
)


def beside(data: pd.DataFrame, by: str | list[str], reference: int = -1) -> pd.DataFrame:
    """Runs with their difference from one of their group."""
    return pd.concat(
        group.assign(difference=difference(group, group.iloc[reference]))
        for _, group in data.groupby(by, sort=False)
    )


def deviations(runs: pd.DataFrame) -> pd.DataFrame:
    """Runs on finer and finer meshes, with the deviations of forces and tips from the last one."""
    last = runs.iloc[-1]
    off = {name: runs[name] / last[name] - 1.0 for name in ("force", "forces")}
    return runs.assign(
        largest=off["force"], sum=off["forces"], tips=difference(runs, last), finest=last["elements"]
    ).iloc[:-1]


def worst(runs: pd.DataFrame) -> dict[str, dict[str, float]]:
    """The largest deviations of the springs, by geometry."""
    sizes = runs.assign(**{name: runs[name].abs() for name in ("largest", "sum", "tips")})
    return sizes.groupby("geometry")[["largest", "sum", "tips"]].max().to_dict("index")


def friction_row(runs: pd.DataFrame) -> dict[str, Any]:
    """Of runs in several numbers of steps the last, in the most, and by what the others differ."""
    last = runs.iloc[-1]
    work = (runs["work"] - last["work"]).abs().max()
    return {**last, "change": difference(runs, last).max(), "work change": work}


def tables(runs: Runs) -> dict[str, pd.DataFrame]:
    """The runs by table, with their difference from one of their group; of wires, from 64 stations."""
    pairs, cycles = beside(runs["pairs"], "spring"), runs["cycles"]
    friction = runs["friction"].groupby(["spring", "mu"], sort=False)
    return {
        "pairs": pairs.assign(time=pairs["seconds"] / pairs.groupby("spring")["seconds"].transform("first")),
        "exponents": beside(runs["exponents"], "spring", 0),
        "friction": pd.DataFrame([friction_row(group) for _, group in friction]),
        "search": runs["search"],
        "geometry": beside(runs["geometry"], ["spring", "mu"]),
        "phases": beside(runs["phases"], "degrees"),
        "cycles": cycles.assign(difference=cycles["work"] / cycles["work"].iloc[-1] - 1.0),
        "forces": pd.concat(deviations(group) for _, group in runs["forces"].groupby(["spring", "geometry"])),
    }


def page(runs: Runs, limit: Mapping[str, Any]) -> str:
    """The page, a view of the runs."""
    found = tables(runs)
    pairs, a = found["pairs"], found["friction"].query("spring == 'A'").set_index("mu")
    few, half, many = (pairs[pairs["pairs"] == count].set_index("spring") for count in (4, 20, 40))
    costs = few.assign(many=many["overlap"], still=half["difference"])
    costs = costs[["overlap", "many", "difference", "still"]].reset_index()
    return template.page(
        WORDS,
        **{name: table.to_dict("records") for name, table in (found | {"costs": costs}).items()},
        slip=runs["friction"].query("spring == 'A' and mu == 0.05 and steps == 50")["last slip"].item(),
        worst={elements: worst(group) for elements, group in found["forces"].groupby("elements")},
        couples=[a["couple"][mu] for mu in (0.1, 0.3, NONE)],
        moment=a["moment"][NONE],
        listed=int(pairs["pairs found"].sum()),
        limit=limit,
    )


def facts(runs: Runs, limit: Mapping[str, Any]) -> dict[str, object]:
    """What findings are computed from: mm, and shares in per cent."""
    tabled, most = tables(runs), runs["search"].iloc[-1]
    pairs, a = tabled["pairs"], tabled["friction"].query("spring == 'A'").set_index("mu")
    found: dict[str, object] = {"pairs.count": int(pairs["pairs"].iloc[0])}
    for row in pairs.groupby("spring", sort=False).head(1).itertuples():
        found[f"pairs.{row.spring}.overlap"] = row.overlap
    found["friction.couples"] = 100.0 * a["couple"][NONE] / a["moment"][NONE]
    found |= {"friction.free": a["uy"][0.0], "friction.held": a["uy"][NONE]}
    found |= {"search.pairs": int(most["pairs"]), "search.outcome": most["outcome"]}
    for row in tabled["geometry"].to_dict("records"):
        key = f"{row['geometry']}.{row['spring']}.{row['mu']:g}.{row['pairs']}"
        found |= {f"{key}.outcome": row["outcome"], f"{key}.time": row["critical time"]}
        found |= {f"{key}.UY": row["uy"], f"{key}.difference": 100.0 * row["difference"]}
    spheres = tabled["geometry"].query("spring == 'A' and geometry == 'spheres' and pairs == 4")
    friction = spheres[(spheres["mu"] > 0.0) & (spheres["mu"] < NONE)]
    found["coulomb.A.4.coefficients"] = friction["mu"].tolist()
    found["coulomb.A.4.differences"] = (100.0 * friction["difference"]).tolist()
    found |= {f"cycle.{row.geometry}.{row.pairs}": row.work for row in tabled["cycles"].itertuples()}
    return found | {"search.along": limit["circ"]}


def write_page(path: Path, record: Path) -> None:
    """Solve all, write the page, and the facts into the folder `record`."""
    runs = {name: measured(group, REPEATS if name == "pairs" else 1) for name, group in RUNS.items()}
    limit = limit_point()
    write_text(path, page(runs, limit))
    write_facts(facts(runs, limit), record)


if __name__ == "__main__":
    write_page(PAGE, RECORD)
