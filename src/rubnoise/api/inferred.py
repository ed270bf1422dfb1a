"""The answer of an inference: estimates, what is not identified or assumed, tests, and what else would fit."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

from rubnoise.answer import Answer, Row, Table, shown
from rubnoise.inference.assumed import OtherPulse
from rubnoise.inference.estimates import Estimate
from rubnoise.inference.inference import InferenceResult

NAMES: Final = (
    "junction_count",
    "diameter",
    "relative_spread",
    "shear_strength",
    "strength_spread",
    "mean_real_contact_area",
    "noise",
)
"""The estimates of an answer, in order."""

LAW_FREE_UNITS: Final = {"effective_diameter": "um"}
"""Units of what needs no law: m6/m5, and the number if sizes were equal."""


def answer_of(found: InferenceResult, name: str) -> Answer:
    """Return what a trace shows about its junctions; it fails if that is too little, or against the model."""
    signal = found.signal
    title = f"{name}: {signal.values.size:,} samples over {signal.tick * signal.values.size:.4g} um of sliding"
    notes = (*signal.left_out, *signal.notes)
    if found.refused_because is not None:
        refused = Row(name="refused", value=found.refused_because, fails=True)
        return Answer(title=title, rows=(refused,), notes=notes, judged="the trace shows its junctions")
    beside = {"laws": _laws(found), "pulses": _others(found), "statistics": _statistics(found)}
    return Answer(
        title=title,
        rows=(*_estimates(found), *_granted(found), *_tests(found)),
        tables=(
            *_by_strength_spread(found),
            *(Table(name=name, columns=columns, shown=()) for name, columns in beside.items() if columns),
        ),
        notes=notes,
        judged="the trace follows the model",
    )


def _estimates(found: InferenceResult) -> Iterator[Row]:
    """Yield the estimates, those of simulated traces, and what has none."""
    alike = [each.law for each in found.laws if not each.told_apart and each.law != found.law]
    note = f"not distinguished from {', '.join(alike)}; intervals hold 95 % whichever is right" if alike else ""
    yield Row(part="estimates", name="law", value=found.law, note=note)
    yield from _rows("estimates", found.estimates)
    for name, reason in found.not_identified.items():
        yield Row(part="not_identified", name=name, note=reason)
    yield from _rows("bootstrap", found.bootstrap)
    for name, value in found.law_free.items():
        yield Row(part="law_free", name=name, value=value, unit=LAW_FREE_UNITS.get(name, ""))


def _rows(part: str, estimates: Mapping[str, Estimate]) -> Iterator[Row]:
    for name in NAMES:
        if (each := estimates.get(name)) is not None:
            unit = "" if each.unit == "1" else each.unit
            error, interval = each.standard_error, each.interval
            yield Row(part=part, name=name, value=each.value, unit=unit, error=error, interval=interval)


def _granted(found: InferenceResult) -> Iterator[Row]:
    """Yield the assumptions, and what other passes and lives would give."""
    for name, words in found.assumptions.items():
        yield Row(part="assumptions", name=name, note=words)
    if (passes := found.other_offset) is not None:
        where = 'off the centre (offset="uniform")' if passes.pulse.offset == "uniform" else "through the centre"
        yield Row(part="assumptions", name="other_passes", note=f"{where} {_compared(passes)}")
    if (lives := found.other_shape) is not None:
        yield Row(part="assumptions", name="other_lives", note=f"of the shape {lives.pulse.shape} {_compared(lives)}")


def _compared(other: OtherPulse) -> str:
    which, size = ("worse" if other.worse_by >= 0.0 else "better"), ("more" if other.diameter_off >= 0.0 else "less")
    told = "" if other.told_apart else ", which decides nothing"
    numbers = [
        f"{name} {shown(float(f'{each.value:.4g}'), each.unit.strip('1'))}"
        for name, each in other.estimates.items()
        if name in {"junction_count", "shear_strength"}
    ]
    diameter = f"diameter {other.diameter:.4g} um ({100.0 * abs(other.diameter_off):.2g} % {size})"
    fit = f"fit {which} by {abs(other.worse_by):.3g} +- {other.error:.2g} of the criterion{told}"
    return f"{fit}, and give {', '.join([diameter, *numbers])}"


def _tests(found: InferenceResult) -> Iterator[Row]:
    """Yield the probability of each test's statistic if the model is right, and a doubt of the shape of lives."""
    for test in found.tests:
        yield Row(part="tests", name=test.name.replace(" ", "_"), value=test.p, note=test.words, fails=test.flagged)
    for words in found.flags[sum(test.flagged for test in found.tests) :]:
        yield Row(part="tests", name="shape_of_lives", value="open", note=words, fails=True)


def _statistics(found: InferenceResult) -> dict[str, list[Any]]:
    """Return the statistic of each test, and the probability below which it is flagged."""
    return {name: [getattr(test, name) for test in found.tests] for name in ("name", "statistic", "level")}


def _laws(found: InferenceResult) -> dict[str, list[Any]]:
    """Return the laws that were compared, with their estimates and standard errors."""
    columns: dict[str, list[Any]] = {"law": [each.law for each in found.laws]}
    for name in ("criterion", "worse_by", "error", "told_apart"):
        columns["worse_by_error" if name == "error" else name] = [getattr(each, name) for each in found.laws]
    return columns | _columns([each.estimates for each in found.laws])


def _others(found: InferenceResult) -> dict[str, list[Any]]:
    """Return the other passes and lives that were tried, with their estimates."""
    tried = [each for each in (found.other_offset, found.other_shape) if each is not None]
    if not tried:
        return {}
    columns: dict[str, list[Any]] = {
        "shape": [each.pulse.shape for each in tried],
        "offset": [each.pulse.offset for each in tried],
        "worse_by": [each.worse_by for each in tried],
        "worse_by_error": [each.error for each in tried],
        "told_apart": [each.told_apart for each in tried],
        "diameter_off": [each.diameter_off for each in tried],
    }
    return columns | _columns([each.estimates for each in tried])


def _columns(several: list[Mapping[str, Estimate]]) -> dict[str, list[Any]]:
    columns = {}
    for name in NAMES:
        if any(name in each for each in several):
            known = [each.get(name) for each in several]
            columns[name] = [None if each is None else each.value for each in known]
            columns[f"{name}_error"] = [None if each is None else each.standard_error for each in known]
    return columns


def _by_strength_spread(found: InferenceResult) -> Iterator[Table]:
    """Yield how number and strength depend on the spread of strengths, if they do."""
    if found.by_strength_spread:
        columns = {
            name: [getattr(each, name) for each in found.by_strength_spread]
            for name in ("strength_spread", "junction_count", "shear_strength")
        }
        told = {name: values for name, values in columns.items() if values[0] is not None}
        yield Table(name="by_strength_spread", columns=told, units={"shear_strength": "MPa"})
