"""``coilcheck calibrate``: the equivalent beam fitted to a measured load curve."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import equivbeam
from coilspring import InputError, Scene, scene_text
from coilspring.benchfile import read_table
from coilspring.measured import Measured, measured
from coilspring.words import plain
from equivbeam.loadcurve import of_force
from validation.study.files import json_bytes
from validation.study.frames import to_csv
from validation.study.machine import versions
from validation.study.partialsolve import partial_path

FAR = 0.5  # rms difference, over the peaks, of a curve that may not be of this spring


def calibrate(
    scene: Scene, file: str | Path, names: tuple[str, ...], **options: Any
) -> tuple[dict[str, bytes], list[str]]:
    """Files of a calibration by name, and what it found for a reader.

    `file`: see `coilspring.benchfile`; `names`: see `equivbeam.calibrate`; `options`: of `equivbeam.solve`.
    """
    table = read_table(file)
    found = equivbeam.calibrate(scene, table, names, **options)
    files = {
        "calibration.json": json_bytes(_summary(scene, file, found)),
        "calibrated.toml": _text(found.scene, names).encode(),
    }
    lines = [*str(found).splitlines(), *_remarks(scene, found)]
    offset = dict(zip(found.names, found.values, strict=True)).get("offset", 0.0)
    try:
        curve = measured(table, scene, "offset" not in names).from_rest(offset, scene)
    except InputError as error:  # a curve that can be fitted need not have force over deflection
        return files, [*lines, f"calibration.png is not drawn: {error}"]
    files["calibration.png"] = _figure(scene, curve, found, options)
    lines += [f"warning: {warning}" for warning in curve.warnings]
    if of_force(table.columns, scene):
        points = pd.DataFrame({"force": curve.force, "deflection": curve.deflection})
        files["measured.csv"] = to_csv(points, digits=9)
        lines += [curve.passed_over] * bool(curve.left_out)
    if offset:
        lines.append("measured.csv and the figure are without the offset: compare with that file")
    return files, lines


def _summary(scene: Scene, file: str | Path, found: equivbeam.Calibration) -> dict[str, Any]:
    """What ``calibration.json`` holds."""
    columns = (found.names, found.values, found.units, found.errors, found.intervals, found.start)
    return {
        "scene": scene.name,
        "measured": str(file),
        "options": found.path.options,
        "parameters": {
            # no standard error where the curve does not determine a value
            name: {
                "value": value,
                "unit": unit or None,
                "standard_error": error,
                "interval": None if np.isnan(error) else interval,
                "start": start,
                "fitted": name not in found.fixed,
            }
            for name, value, unit, error, interval, start in zip(*columns, strict=True)
        },
        "rank": found.rank,
        "alike": [{"names": [one, other], "correlation": of} for one, other, of in found.alike],
        "residual": found.rms_after,
        "residual_before": found.rms_before,
        "scatter": found.scatter,
        "misfit": found.misfit or None,
        "evaluations": found.evaluations,
        "versions": versions(),
    }


def _remarks(scene: Scene, found: equivbeam.Calibration) -> list[str]:
    """What a reader should know of the scene that was fitted."""
    lines, before, nu = [], scene.material.nu, found.scene.material.nu
    if not np.isclose(nu, before, rtol=1e-9, atol=0.0):
        lines.append(f"Poisson's ratio {before:.4g} -> {nu:.4g}: it follows from E and G")
    if found.rms_before > FAR:
        far = f"far from the curve, {plain(100 * found.rms_before)} % of the peaks rms"
        lines.append(f"warning: the scene as given is {far}: are its spring and the units right?")
    sliding = scene.contact.sliding
    if scene.contact.enabled and sliding != "free":
        lines.append(f"fitted without the scene's sliding = \"{sliding}\", as the paper's model")
    return lines


def _figure(scene: Scene, curve: Measured, found: equivbeam.Calibration, options: dict[str, Any]) -> bytes:
    """Force and rate over deflection of a curve from rest, and of the scene before and after the fit."""
    from validation.calibration.figure import FIT, load_curves

    start = replace(scene, load=found.path.scene.load)
    paths = {"given": partial_path(equivbeam.solve, start, **options), "calibrated": found.path}
    return load_curves(paths, curve, FIT)


def _text(scene: Scene, names: tuple[str, ...]) -> str:
    """Text of a fitted scene; G in place of Poisson's ratio where that was fitted, or is the rounder."""
    text, nu, G = scene_text(scene), repr(scene.material.nu), f"{scene.material.G:.12g}"
    if "G" not in names and len(nu) <= len(G):
        return text
    line = f"G = {G}".ljust(35) + " # shear modulus; or nu, Poisson's ratio"
    return re.sub(r"(?m)^nu = .*$", line, text, count=1)
