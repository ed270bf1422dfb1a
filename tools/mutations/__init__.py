"""The faults that `tools/mutants.py` puts into a copy of the program, by room, each with the test that notices it."""

from __future__ import annotations

from mutations import (
    analysis,
    api,
    contact,
    inference,
    lesson,
    outside,
    record,
    scenario,
    simulation,
    storage,
    sweep,
    theory,
)
from mutations.mutant import Edit, Mutant, one

__all__ = ["MUTANTS", "ROOMS", "Edit", "Mutant", "one"]

ROOMS = {
    "contact": contact.MUTANTS,
    "simulation": simulation.MUTANTS,
    "record": record.MUTANTS,
    "theory": theory.MUTANTS,
    "scenario": scenario.MUTANTS,
    "inference": inference.MUTANTS,
    "storage": storage.MUTANTS,
    "analysis": analysis.MUTANTS,
    "sweep": sweep.MUTANTS,
    "api": api.MUTANTS,
    "cli": outside.CLI,
    "figures": outside.FIGURES,
    "claims": outside.CLAIMS,
    "lesson": lesson.MUTANTS,
    "pages": outside.PAGES,
}
MUTANTS = tuple(mutant for room in ROOMS.values() for mutant in room)
