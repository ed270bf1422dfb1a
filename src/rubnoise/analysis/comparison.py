"""Compare a run with the theory of its scenario: only its stored rows count, and no figure that it has stored."""

from collections.abc import Callable
from dataclasses import replace

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.comparing.asked import Cubes, asked_findings
from rubnoise.analysis.comparing.births import Births, birth_findings
from rubnoise.analysis.comparing.contact import area_findings, count_findings, force_findings, missing_length
from rubnoise.analysis.comparing.findings import Comparison, Finding, Findings, comparison
from rubnoise.analysis.comparing.free import free_comparison
from rubnoise.analysis.comparing.lives import Lives, life_findings
from rubnoise.analysis.comparing.load import first_still_tick, load_findings
from rubnoise.analysis.comparing.motion import (
    Path,
    first_tick,
    mean_force_findings,
    motion_findings,
    two_way_identities,
)
from rubnoise.analysis.comparing.noise import covariance_findings, distribution_findings, spectrum_findings
from rubnoise.analysis.comparing.sizes import AliveAtStart, Marks, mark_findings, start_findings
from rubnoise.analysis.comparing.trace import TraceSums, read_trace
from rubnoise.analysis.reading import checked_chunks
from rubnoise.analysis.records import RecordTooShort
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.model import Model
from rubnoise.record.reader import Rows
from rubnoise.theory.motion import response

COLUMNS = ("birth_distance", "death_distance", "life_distance", "diameter", "lateral_offset", "shear_strength", "state")


def compare(model: Model, rows: Rows, bound: float | None = None) -> Comparison:
    """Return the comparison of a run with theory; ``bound`` replaces the family-wise bound on |z|.

    The run is read twice, /trace and /junctions once each (and /slider), in chunks. Raises RecordTooShort, with the
    mean area, for a run too short even for a score of that, RunFileRefused for damaged rows.
    """
    if model.free is not None:
        return free_comparison(model, model.free, rows, bound)
    trace = read_trace(model, rows)
    missing = missing_length(model, trace)
    if missing is not None:
        length = trace.ticks * model.tick
        raise RecordTooShort("a comparison with the theory", trace.area.mean, length=length, needed=missing)
    births, start, marks, lives, cubes = Births(model), AliveAtStart(), Marks(model), Lives(model, trace), Cubes()
    path = Path(model, rows) if model.is_two_way else None
    for columns in checked_chunks(rows, "junctions", COLUMNS):
        for gathered in (births, start, marks, lives, cubes):
            gathered.add(columns)
        if path is not None:
            path.add(columns)
    parts = (
        _part("births", birth=lambda: birth_findings(model, births), start=lambda: start_findings(model, start)),
        _part(
            "junctions",
            diameter=lambda: mark_findings(model, marks),
            asked=lambda: asked_findings(model, cubes),
            life=lambda: life_findings(model, lives, trace),
        ),
        _trace_part(model, trace),
        _balance_part(model, path),
        _part(
            "slider",
            lambda: first_tick(model, response(model)) * model.tick,
            displacement=lambda: motion_findings(model, rows),
        ),
        _part("load", lambda: first_still_tick(model) * model.tick, load=lambda: load_findings(model, rows)),
    )
    return comparison(parts, bound)


def _balance_part(model: Model, path: Path | None) -> Findings:
    if path is None:
        return Findings(heading="balance", found=())
    return _part(
        "balance",
        balance=lambda: two_way_identities(model, path),
        mean_force=lambda: mean_force_findings(model, path),
    )


def _trace_part(model: Model, trace: TraceSums) -> Findings:
    return _part(
        "contact",
        lambda: trace.layout.stationary_from * model.tick,
        real_contact_area=lambda: area_findings(model, trace),
        real_contact_area_kolmogorov=lambda: distribution_findings(model, trace),
        junction_count=lambda: count_findings(model, trace),
        friction_force=lambda: force_findings(model, trace),
        real_contact_area_autocovariance=lambda: covariance_findings(model, trace),
        spectrum=lambda: spectrum_findings(model, trace),
    )


def _part(heading: str, begins: Callable[[], float] = lambda: 0.0, **parts: Callable[[], list[Finding]]) -> Findings:
    """Return the findings of the parts; of a part that theory refuses, its name and the reason.

    ``begins``: where in um the record of the figures begins. Raises RunFileRefused for damaged rows.
    """
    found: list[Finding] = []
    for name, find in parts.items():
        try:
            found += find()
        except RunFileRefused:
            raise
        except Refused as refusal:
            found.append(LeftOut(name=name, reason=str(refusal)))
    part = Findings(heading=heading, found=tuple(found))
    return replace(part, begins=begins()) if part.figures else part
