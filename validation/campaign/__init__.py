"""Stability campaign: sampled scenes, verified by equations and geometry of its own, in plain numpy.

The verifier shares the classes of scenes with the models, and the two Python functions of a user's law. Of a
path it takes the states, and of the wire model's also which points are pairs and what each remembers: lists
and memories are checked by the forces in balance, and by a search for pairs that touch and are not listed.
Other runs of a scene, also by arc length, are the models' own.
"""
