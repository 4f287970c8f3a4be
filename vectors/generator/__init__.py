"""Makes the cases of vectors/*.json: one module a topic, expected values in 50 digits or exact fractions.

Implements: VEC-008.
"""

from . import bank, coloured, decision, elements, filters, normal, nuisances, probe, proportions, quadratic, reports, requests
from . import scan, servo, tables, threshold
from .suite import VERSION

__all__ = ["VERSION", "all_groups"]

TOPICS = (
    normal, decision, threshold, filters, coloured, nuisances, bank, scan, proportions, quadratic, tables, servo, reports, elements, probe, requests
)


def all_groups():
    return [make() for topic in TOPICS for make in topic.GROUPS]
