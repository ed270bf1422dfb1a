"""rubnoise on the benchmark's cases: whole runs into a file, and the area alone."""

from pathlib import Path
from typing import Any

import rubnoise
from bench.case import AREA, DAMPING, MASS, SEED, SPEED, STIFFNESS, STRENGTH, Case, Draws, Output, doubles


def scenario(case: Case, engine: str, seed: int = SEED) -> rubnoise.Scenario:
    """Return a case as a scenario."""
    return rubnoise.build(
        {
            "format": 1,
            "title": "Benchmark",
            "interface": {
                "mean_real_contact_area": AREA,
                "mean_junction_count": case.mean_count,
                "calibration": "paper",
            },
            "diameter": {"law": "normal", "spread": case.diameter_std},
            "strength": {"law": "constant", "mean": STRENGTH},
            "sliding": {"distance": case.distance, "speed": SPEED, "start": "empty"},
            "slider": {"mass": MASS, "stiffness": STIFFNESS, "damping": DAMPING, "start": "rest"},
            "output": {"tick": case.tick},
            "run": {"seed": seed, "engine": engine},
        }
    )


def output(record: Any) -> Output:
    """Return what a record or an opened result holds."""
    junctions, trace = record["junctions"], record["trace"]
    return Output(
        area=doubles(trace["real_contact_area"]),
        displacement=doubles(record["slider"]["displacement"]),
        birth=doubles(junctions["birth_distance"]),
        death=doubles(junctions["death_distance"]),
    )


def run(case: Case, draws: Draws, path: Path, engine: str) -> None:
    """Make a whole run: every table, the summary beside theory and the hashes, on disk."""
    rubnoise.run(scenario(case, engine, draws.seed), path, force=True, command=["bench"]).close()


def in_memory(case: Case, engine: str) -> rubnoise.Record:
    """Return a run as a record, without a file."""
    return rubnoise.simulate(scenario(case, engine))
