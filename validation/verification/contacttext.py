"""Words of the page on the wire model's contact; numbers in braces are filled in."""

from __future__ import annotations

HEAD = """\
# Contact in the wire model

Written by `python -m validation.verification.contact`; every number is computed there. Unless said
otherwise: straight elements, 40 per turn; 4 pairs per turn; K = 1e4 N/mm; 50 steps; the catalogue's sliding
(A frictionless, B none). Results at full load; mm, N, rad. Equations: [theory.md](theory.md), section 3. The
model is compared with itself, not with a measured spring; times depend on the machine.
"""

PAIRS_TEXT = """
## Sphere pairs per turn

The stiffness per length of wire is kept: each of p pairs per turn has 4 K/p. *Overlap*: wire diameter less
the least distance of the centrelines of neighbouring coils, sampled 160 times per turn, so between the pairs
too. *Difference*: the largest of UX, UY, ROTZ, relative.

"""

PAIRS_WORDS = """\
What 4 pairs per turn cost:
{costs}.
From 20 to 40 pairs the tips of A still move by {still}. More pairs do not take all overlap away: where two
spheres slide by s along the wire, the wires come nearer by s^2/(2 d), whatever the number of pairs; that is
{sink:.3f} mm for the largest slip of Spring A with mu = {mu:g}, {slip:.2f} mm, if all of it is along the
wire.
"""

EXPONENT_TEXT = """
## Exponent

F = K max(0, d - h)^k, with K such that all exponents give {force:g} N at a penetration of {like:g} mm.
Where pairs penetrate less than that, a larger exponent is softer.

"""

FRICTION_TEXT = """
## Friction

Results with {most} requested steps; *change*: largest relative difference of UX, UY, ROTZ, and of the work,
of {fewer} steps from them. *Couple left*: size of the sum of g x f_t over the pairs.

"""

FRICTION_WORDS = """\
The slip is found implicitly (backward Euler): the work is right to first order in the step. No sliding, and
friction where pairs stick, keep where a pair stood at the end of the substep in which it closed; that is
what the tips of A depend on.

The tangential force acts at the centres of the spheres and not where the wires touch: so the definition of
no sliding has it, which friction shares. The forces of a pair balance, its couple g x f_t remains, as if
the ground took it. The load of Spring A has a moment of {moment:.0f} N mm about the bottom; the couples are
{small} of it with mu = 0.1, {middle} with 0.3 and {none} with no sliding. What large coefficients do to A
is this definition's, and need not be what wires do that rub at their surfaces.
"""

SOLVER = """
## Solver and stability

Within a substep the bound of a pair's tangential force is a line over its slip, so that every iteration
minimises a potential whose matrix is symmetric: LDL^T, as without friction. After convergence the bounds
are updated from the normal forces and the equilibrium is found again, until they change by at most 1e-6 of
the largest (the fixed point of Panagiotopoulos 1975), at most 30 times; otherwise the substep is halved.
Accepted states then satisfy Coulomb's law implicitly, without the unsymmetric tangent of a linearised
bound; forces balance to that 1e-6 of the largest bound. Slip, work and the points of sticking change with
accepted substeps only.

- Without friction, no negative pivot means a stable equilibrium.
- With no sliding the pivots are those of the incremental energy at a frozen contact history.
- With friction the slope of the bounds is that with which the normal forces answer to the sliding, on average
  over the pairs ([theory.md](theory.md)). So paths go on to the limit points of Coulomb's law, where coils
  slip off each other. Flutter, and instabilities of Coulomb's law in some directions only, are not excluded.
- The answer depends on the sequence of loads, and on the substeps by as much as the table says.
- `wirefe.trace` rejects friction: its arc is not a history of loads.
"""

SEARCH_TEXT = """
## Search

Pairs are spheres one turn apart. After every accepted substep the model looks for others that overlap: more
than half a turn apart along the wire and not on one rigid end; it does not look before a bound on all moves
since rest has used up the least gap that such spheres had there. If it finds any, all those
nearer than 1.5 wire diameters become pairs, and the substep is taken again. *Unlisted*: overlaps
at the stored states that an independent search finds beside the model's pairs. As many curved
elements as pairs per turn; 10 steps.

"""

SEARCH_WORDS = """\
The runs of the first table found {listed} pairs. Arc length finds {traced} in frictionless Spring B past
its limit point (160 points, 4 pairs per turn): its spheres slide off each other and on to the next.

A pair that was found is as stiff as any other: wires are stiffer where diagonal neighbours overlap too.

At the limit point of frictionless Spring B (t = {limit:.4f}, arc length, 4 pairs per turn) the closed pair
that moves most, spheres {first} and {second}, moves along the wire: {circ:.0f} % of its distance. Spheres
pressed on each other are unstable in that direction, smooth wires are not. The limit point belongs to the
spheres: where they stand so close that diagonal neighbours touch first, the spring completes.
"""
