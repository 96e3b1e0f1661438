"""The paper's law with radial expansion and change of the helix angle, in first order: its own outlook.

The wire of a half coil keeps its length s, and its ends do not turn about the axis. So the coil's diameter is
D = 2 sqrt(s^2 - l^2) / pi, and cos p is in proportion to D. Of the paper's stiffnesses the axial and the
shearing one, with cos p / D^3, grow by 2 tan^2 p / l per length; the bending one, with cos p / D, stays.
"""

from math import cos, tan


def parameters(coil):
    d, D, E, G, p = coil.wire_diameter, coil.mean_diameter, coil.E, coil.G, coil.helix_angle
    c, rate = d**4 * cos(p), 2 * tan(p) ** 2 / coil.length
    return G * c / (4 * D**3), E * c / (4 * D**3), E * G * c / (8 * D * (2 * G + E)), coil.length, rate


def energy(l, v, dtheta, p):  # noqa: E741
    axial, shear, bending, length, rate = p
    x = l - length
    stretched = axial * (
        x**2 / 2 + rate * x**3 / 3
    )  # its force is the paper's, (7), with the current stiffness
    return stretched + shear * (1 + rate * x) * v**2 / 2 + bending * dtheta**2 / 2
