"""The rate of a measured curve: its slope over a window that is wide enough for the scatter of its points."""

import numpy as np

from coilspring.measured import Measured

WINDOW = 0.1  # of the largest deflection
MOST = 400  # windows, at points evenly chosen
FEWEST = 5  # points of a window, which is wider where they are sparse
LABEL = "measured: slope over a tenth of the deflection"


def slope(curve: Measured) -> tuple[np.ndarray, np.ndarray]:
    """Deflections, mm, and slopes there, N/mm, of the least-squares line over the `WINDOW` around each point.

    A slope stands at the mean deflection of its points. They are those up to the largest force, or from it on
    where these go further: friction parts loading from unloading. There are none of fewer than `FEWEST`.
    """
    peak = int(np.argmax(curve.force))
    branches = (slice(peak + 1), slice(peak, None))
    rows = max(branches, key=lambda branch: float(np.ptp(curve.deflection[branch])))
    deflection, force = curve.deflection[rows], curve.force[rows]
    half = 0.5 * WINDOW * float(deflection.max())
    found = []
    centres = np.sort(deflection)[:: 1 + deflection.size // MOST]
    for centre in centres if deflection.size >= FEWEST else ():
        distance = np.abs(deflection - centre)
        near = distance <= max(half, float(np.partition(distance, FEWEST - 1)[FEWEST - 1]))
        middle = float(deflection[near].mean())
        x = deflection[near] - middle
        if (size := float(x @ x)) > 0.0:  # else points at rest, which have no slope
            found.append((middle, float(x @ force[near]) / size))
    at, slopes = np.array(found).reshape(-1, 2).T
    return at, slopes
