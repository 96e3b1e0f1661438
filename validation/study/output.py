"""What the files of a run hold, and which of those that are there belong to it."""

import json
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from coilspring.path import EquilibriumPath
from coilspring.scene.scene import SECTIONS
from coilspring.scene.toml import scene_table
from coilspring.words import rounded
from validation.study.files import TEMPORARY, content_of, json_bytes, json_text, keep, write_files, writing
from validation.study.machine import versions
from validation.study.scenewarnings import warnings

# attributes of a path that its summary has
SUMMARY = (
    *("critical_time", "critical_bracket", "undecided_time", "end_bracket", "total_iterations"),
    *("stability_checks", "pair_evaluations", "residual_history", "solve_seconds", "compile_seconds"),
    *("accuracy", "estimated_error", "other_seconds"),
)
OPTIONAL = {  # files that a run may have, by the file that every run of its kind has
    "summary.json": ("stress.csv", "wire.pvd", "wire.vtu"),
    "compare.json": ("compare.png", "curve.png"),
    "calibration.json": ("calibration.png",),  # measured.csv may be the user's
}
RESULTS = ("pairs_found",)  # what stands among the options of a path and is none
AMONG_OPTIONS = ("load.steps", "contact.stiffness")  # keys of a scene that a summary has among the options


def path_files(path: EquilibriumPath, found: Mapping[str, object]) -> dict[str, bytes]:
    """``path.csv`` and ``summary.json`` of a path, complete or not, with its summary."""
    return {"summary.json": json_bytes(found), "path.csv": _csv(path.columns).encode()}


def _csv(columns: Mapping[str, np.ndarray]) -> str:
    """Columns as CSV, each number to its last digit; pandas would take longer to import than to solve."""
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return "".join(",".join(map(str, row)) + "\n" for row in (tuple(columns), *rows))


def write_runs(runs: Mapping[Path, Mapping[str, bytes]], read: Sequence[str | Path] = ()) -> list[str]:
    """Write files of runs by folder, all or none, and remove others of the runs that were there.

    In lines what was removed, and what is kept, see `keep`: what was of no run, and files that were `read`.
    """
    earlier = [folder for folder, files in runs.items() if _is_run(folder, files)]
    inputs = [Path(file).resolve() for file in read]
    lines = []
    for folder, files in runs.items():
        for name, data in files.items():
            target = folder / name
            what = "read" if target.resolve() in inputs else "there and is of no run"
            if (what == "read" or folder not in earlier) and content_of(target) not in (None, data):
                lines.append(f"{name}, which was {what}, is kept in {keep(target)}")
    write_files({str(folder / name): data for folder in runs for name, data in runs[folder].items()}, Path())
    for folder in earlier:
        removed = _remove_stale(runs[folder], folder)
        lines += [f"{', '.join(removed)} of the run that was there: removed"] if removed else []
    return lines


def _is_run(folder: Path, files: Mapping[str, bytes]) -> bool:
    """Whether a folder has a run of ours of the same kind as one of these `files`."""
    return any("scene" in _summary(folder / name) for name in OPTIONAL.keys() & files.keys())


def _summary(file: Path) -> dict[str, Any]:
    """What a file holds as JSON; nothing where there is none, or something else."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _remove_stale(files: Mapping[str, bytes], folder: Path) -> list[str]:
    """Remove what an earlier run left there, by the names that runs give, and is none of these `files`; what
    was, without the files of a series."""
    removed = []
    optional = [name for kind in OPTIONAL.keys() & files.keys() for name in OPTIONAL[kind]]
    with writing(folder):
        series = [file for file in folder.glob("wire/*.vtu") if file.stem.isdecimal() and len(file.stem) >= 4]
        ours = series if "wire.pvd" in optional and (folder / "wire.pvd").is_file() else []
        for target in (*(folder / name for name in optional), *ours):
            if target.relative_to(folder).as_posix() not in files and target.is_file():
                target.unlink()
                removed += [target.name] if target not in ours else []
        if ours:
            with suppress(OSError):  # there is something in it
                (folder / "wire").rmdir()
    return removed


def largest_stress(path: EquilibriumPath) -> dict[str, float] | None:
    """Largest shear stress of the wire, MPa; when it is, and how many turns above the first active point."""
    if path.max_stress is None or not len(path.times):
        return None
    from wirefe import stress

    step = int(path.max_stress.argmax())
    value, turns = stress(path, step).largest()
    return {"value": value, "time": float(path.times[step]), "turns": turns}


def replaced(folder: Path, found: Mapping[str, object]) -> list[str]:
    """In a line what a summary will take the place of: a run in `folder` of another scene, or of one that had
    other keys, or with another model or options."""
    try:
        old, new = _summary(folder / "summary.json"), json.loads(json_text(found))
        was, options = ({k: v for k, v in each["options"].items() if k not in RESULTS} for each in (old, new))
        same = was == options and all(old.get(key) == new[key] for key in ("scene", "scene_table", "model"))
        scene = f" of {old['scene']}" if old["scene"] != new["scene"] else ""
        changed = [f"{key} {value}" for key, value in was.items() if value != options.get(key)]
        if not scene:
            changed += _other_keys(old["scene_table"], new["scene_table"])
    except (KeyError, TypeError, AttributeError):
        return []  # none, or of something else
    by = f"{old['model']} ({', '.join(changed)})" if changed else str(old["model"])
    return [] if same else [f"in place of a run{scene} by {by}, which was there"]


def _other_keys(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Keys of a scene, with their values, that a new one of the same name has not, or otherwise."""
    keys = {
        f"{section}.{key}": (rounded(value), rounded(new[section].get(key)))
        for section in SECTIONS
        for key, value in old[section].items()
    }
    return [f"{key} {was}" for key, (was, now) in keys.items() if was != now and key not in AMONG_OPTIONS]


def stress_file(path: EquilibriumPath) -> dict[str, bytes]:
    """``stress.csv``: forces and stresses along the wire at the last step reached by the wire model."""
    from wirefe import stress

    return {"stress.csv": _csv(stress(path).columns).encode()}


def vtu_file(path: EquilibriumPath) -> dict[str, bytes]:
    """``wire.vtu``: the deformed wire at the last step reached by the wire model."""
    return _vtu_files(path, {"wire.vtu": -1})


def series_files(path: EquilibriumPath) -> dict[str, bytes]:
    """``wire.pvd`` and, in the folder ``wire``, a VTU file for every step reached by the wire model."""
    steps = {f"wire/{step + 1:04d}.vtu": step for step in range(len(path.times))}
    sets = (f'    <DataSet timestep="{path.times[i]:.12g}" file="{name}"/>\n' for name, i in steps.items())
    head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
    series = f"{head}{''.join(sets)}  </Collection>\n</VTKFile>\n"
    return {"wire.pvd": series.encode(), **_vtu_files(path, steps)}


def _vtu_files(path: EquilibriumPath, steps: Mapping[str, int]) -> dict[str, bytes]:
    """VTU files of the deformed wire at steps by name; meshio writes them to a disk alone."""
    from wirefe.results.export import write_vtu

    found = {}
    with writing(TEMPORARY), tempfile.TemporaryDirectory(prefix="coilcheck-") as made:
        for name, step in steps.items():
            write_vtu(path, step, file := Path(made, "wire.vtu"))
            found[name] = file.read_bytes()
    return found


# what the wire model can write besides a path, by option
WIRE_FILES = {"vtu": vtu_file, "stress": stress_file, "vtu_series": series_files}


def summary(path: EquilibriumPath) -> dict[str, object]:
    """What ``summary.json`` holds."""
    load, contact = path.scene.load, path.scene.contact
    return {
        "scene": path.scene.name,
        "scene_table": scene_table(path.scene),
        "wire_diameter": path.scene.spring.wire_diameter,
        "model": path.model,
        "outcome": path.outcome,
        "message": path.message,
        "warnings": warnings(path.scene),
        "last_time": path.times[-1] if len(path.times) else 0.0,
        "largest_stress": largest_stress(path),
        **{name: getattr(path, name) for name in SUMMARY},
        "options": {"steps": load.steps, "penalty": contact.stiffness, **path.options},
        "versions": versions(),
    }
