"""The paper's law of a half coil, after Haringx: constant stiffnesses, as a user would write it."""

from math import cos


def parameters(coil):
    d, D, E, G = coil.wire_diameter, coil.mean_diameter, coil.E, coil.G
    c = d**4 * cos(coil.helix_angle)
    return G * c / (4 * D**3), E * c / (4 * D**3), E * G * c / (8 * D * (2 * G + E)), coil.length


def energy(l, v, dtheta, p):  # noqa: E741
    axial, shear, bending, length = p
    return (axial * (l - length) ** 2 + shear * v**2 + bending * dtheta**2) / 2
