"""Makes the cases of vectors/*.json: one module a topic, expected values in 50 digits or exact fractions.

Implements: VEC-008, VEC-019.
"""

from multiprocessing import Pool

from . import bank, conditions, coloured, decision, elements, filters, normal, nuisances, probe, proportions, quadratic, reports, requests
from . import robust, scan, sequential, servo, tables, threshold
from .suite import VERSION

__all__ = ["VERSION", "all_groups"]

TOPICS = (
    normal, decision, threshold, filters, coloured, nuisances, bank, robust, sequential, scan, proportions, quadratic, tables, servo, reports, elements, probe, requests
)


def make(number):
    return [make for topic in TOPICS for make in topic.GROUPS][number]()


def found(question):
    return conditions.of_case(*question)


def all_groups():
    """All groups with their conditions. Cases do not depend on each other, so that the number of processes changes nothing."""
    with Pool() as pool:
        # From the end: of the slow groups the slowest is begun first.
        groups = pool.map(make, reversed(range(sum(len(topic.GROUPS) for topic in TOPICS))), 1)[::-1]
        cases = [(group, case) for group in groups for case in group.cases]
        questions = [(group.op, case, {**group.tolerance, **case.get("tolerance", {})}) for group, case in cases]
        for (_, case), more in zip(cases, pool.map(found, questions, 8)):
            conditions.add(case, more)
    return groups
