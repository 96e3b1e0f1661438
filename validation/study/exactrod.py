"""Tips of the paper's springs without contact as exact Cosserat rods."""

from __future__ import annotations

from collections.abc import Mapping

# UX, UY in mm, ROTZ in rad at two times: rigid end turns and the default material, integrated by shooting
# to 1e-10. Our own numbers, not published ones.
EXACT_ROD: Mapping[str, Mapping[float, tuple[float, float, float]]] = {
    "spring-a-no-contact": {
        0.5: (-13.325870, -3.912853, 0.707779),
        1.0: (-21.260191, -10.464994, 1.200717),
    },
    "spring-b-no-contact": {0.5: (0.0, -12.476115, 0.0), 1.0: (0.0, -25.060823, 0.0)},
}
