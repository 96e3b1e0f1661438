"""The equivalent beam in the plane across: for springs that are loaded along their axis.

Such a spring has no working plane of its own. Its coils meet first beside the plane in which the wire leaves
the end turns: the end of a coil that is held there tilts the axis about the radius to it, and a quarter of a
turn from there this tilt moves the wire most. Here the beam lies in that plane, with its nodes at the ends
and at phases pi/2 + k pi; the pairs at k pi, which lie beside this one, touch in the middle of half coils.
"""
