"""Makes the cases of vectors/*.json: one module a topic, expected values in 50 digits or exact fractions."""

from . import decision, filters, normal, tables
from .suite import VERSION

__all__ = ["VERSION", "all_groups"]


def all_groups():
    return [make() for topic in (normal, decision, filters, tables) for make in topic.GROUPS]
