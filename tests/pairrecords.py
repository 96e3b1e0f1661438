"""Records of the contact history for parts of kernels that are called as plain Python."""

import numpy as np

from coilspring.contact.law import PAIR_HISTORY


def pair_records(count=1, **values):
    """Equal records, with the values given and zeros; their fields are attributes, as in compiled code."""
    records = np.zeros(count, PAIR_HISTORY)
    for name, value in values.items():
        records[name] = value
    return records.view(np.recarray)


def held(vector, bound=np.inf, **values):
    """Record of a pair that closed with a vector between its centres, of a stiffness of 1e4 N/mm."""
    normal = vector / np.linalg.norm(vector)
    stiff = {"stiffness": 1e4, "whole": 1e4}
    return pair_records(closed=True, vector=vector, normal=normal, bound=bound, **stiff, **values)[0]
