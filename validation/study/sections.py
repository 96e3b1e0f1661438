"""Random springs of sections, of which studies solve some."""

import math

import numpy as np

from coilspring import CoilSection, Spring

MOST_SECTIONS, STEEPEST = 4, 2.0  # of a spring; wire diameters by which a coil may be wider than the next


def in_sections(rng: np.random.Generator, spring: Spring) -> Spring:
    """A spring of sections of half coils in place of one, which begins anywhere."""
    d, halves = spring.wire_diameter, round(2 * spring.active_coils)
    inner = rng.choice(np.arange(1, halves), rng.integers(min(MOST_SECTIONS, halves)), replace=False)
    coils = 0.5 * np.diff([0, *np.sort(inner), halves])
    sections, bottom = [], spring.mean_diameter[0]
    for number in coils.tolist():
        wider = min(STEEPEST * number, 11.0) * d * rng.uniform(-1.0, 1.0) * (rng.random() < 0.6)
        top = float(np.clip(bottom + wider, 4.0 * d, 15.0 * d))
        pitches = d * np.exp(rng.uniform(math.log(1.05), math.log(max(1.6, 0.2 * min(bottom, top) / d)), 2))
        pitch = (pitches if rng.random() < 0.5 else pitches[[0, 0]]).tolist()
        sections.append(CoilSection(number, tuple(pitch), (bottom, top)))
        bottom = top
    end_turns, phase = spring.end_turns, rng.uniform(0.0, 2.0 * math.pi)
    ends, hand = "open" if rng.random() < 0.3 else "closed", "right" if rng.random() < 0.5 else "left"
    return Spring.of_sections(d, sections, end_turns=end_turns, start_phase=phase, ends=ends, hand=hand)
