"""``coilcheck calibrate``: the equivalent beam fitted to a measured load curve."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import equivbeam
from coilspring import EquilibriumPath, Scene, scene_text
from coilspring.measured import measured, table_of
from equivbeam.parameters import values
from validation.study.machine import versions
from validation.study.output import json_bytes
from validation.study.partialsolve import partial_path


def calibrate(
    scene: Scene, file: str | Path, names: tuple[str, ...], **options: Any
) -> tuple[dict[str, bytes], list[str]]:
    """Files of a calibration by name, and what it found for a reader.

    Parameters
    ----------
    file : CSV file, see `coilspring.measured`.
    names : of the parameters, see `equivbeam.calibrate`.
    **options : of `equivbeam.solve`.
    """
    table = table_of(file)
    found = equivbeam.calibrate(scene, table, names, **options)
    files = {
        "calibration.json": json_bytes(_summary(scene, found, options)),
        "calibrated.toml": scene_text(found.scene).encode(),
    }
    lines = str(found).splitlines()
    if scene.contact.enabled and scene.contact.sliding != "free":
        lines.append(
            f"fitted without the scene's sliding = \"{scene.contact.sliding}\", as the paper's model"
        )
    if "force" in table or "load_y" in table:
        from validation.calibration.figure import FIT, load_curves

        curve = measured(table, scene)
        given: EquilibriumPath = partial_path(
            equivbeam.solve, replace(scene, load=found.path.scene.load), **options
        )
        files["calibration.png"] = load_curves({"given": given, "calibrated": found.path}, curve, FIT)
        if curve.left_out:
            lines.append(f"{curve.left_out} points without load left out")
    return files, lines


def _summary(scene: Scene, found: equivbeam.Calibration, options: dict[str, Any]) -> dict[str, object]:
    """What ``calibration.json`` holds; no standard error where the curve does not determine a value."""
    start = values(scene, found.names)
    return {
        "scene": scene.name,
        "options": {name: str(value) for name, value in options.items()},
        "parameters": {
            name: {
                "value": value,
                "standard_error": None if np.isnan(error) else error,
                "start": begin,
                "fitted": name not in found.fixed,
            }
            for name, value, error, begin in zip(found.names, found.values, found.errors, start, strict=True)
        },
        "rank": found.rank,
        "residual": found.rms_after,
        "residual_before": found.rms_before,
        "evaluations": found.evaluations,
        "versions": versions(),
    }
