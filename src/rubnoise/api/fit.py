"""The result of `infer`: an answer, a table, a scenario, a picture, a page and a file."""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rubnoise.answer import Answer, Row, Table, shown
from rubnoise.api.notebook import DataFrame
from rubnoise.contact.laws import LAWS
from rubnoise.errors import Refused, needing
from rubnoise.figures import Figure
from rubnoise.inference.estimates import NAMES, Estimate
from rubnoise.inference.fitting import Fit
from rubnoise.inference.inference import InferenceResult, Tried
from rubnoise.scenario.text import text_of
from rubnoise.storage.output import whole_file
from rubnoise.tables import shortened

if TYPE_CHECKING:
    from rubnoise.scenario import Scenario


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Inference(InferenceResult):
    """What a trace shows about its junctions: ``found.estimates["diameter"].interval``.

    ``estimates`` by name, ``tests`` of the trace against the model, ``flags`` what speaks against it, ``laws``
    compared. ``scenario`` simulates what was found; ``plot``, ``report`` and ``save`` keep it. ``name`` is that of the
    trace, ``speed`` its speed in um/s, ``strength`` the one in MPa that was known.

    >>> import rubnoise
    >>> found = rubnoise.infer("fig5.h5", zero="known", law="normal")
    >>> low, high = found.estimates["junction_count"].interval
    >>> low < 20.0 < high
    True
    """

    name: str = "trace"
    speed: float | None = None
    strength: float | None = None

    def to_toml(self) -> str:
        """Return the text of a scenario that simulates what was found, over the distance of the trace.

        Raises Refused if number or strength is not identified.
        """
        fit, signal, found = self._found("write"), self.signal, self.estimates
        for name in ("junction_count", "mean_real_contact_area"):
            if name not in found:
                raise Refused(f"{name} is not identified, and a scenario needs it: {self.not_identified[name]}")
        count, shape, sizes = found["junction_count"].value, fit.contact.shape, {"law": self.law}
        if self.law == "normal":
            diameter = found["diameter"].value
            # The scenario's centre is that before drawing again, and N_jm counts lives of that length.
            count *= fit.problem.population.law(diameter, shape).centre / diameter  # type: ignore[attr-defined]
        if LAWS[self.law].takes_spread:
            sizes["spread"] = f"{100.0 * shape:.6g} %"
        psi = found["shear_strength"].value if "shear_strength" in found and self.strength is None else self.strength
        strength = {} if psi is None else {"mean": f"{psi:.6g} MPa"}
        spread = sqrt(max(fit.contact.inequality - 1.0, 0.0))  # E[psi^2] / E[psi]^2 is 1 for equal strengths
        if strength and spread:
            strength |= {"law": "lognormal", "spread": f"{100.0 * spread:.6g} %"}
        pulse = {"shape": fit.problem.pulse.shape, "offset": fit.problem.pulse.offset}
        keys: dict[str, Any] = {
            "format": 1,
            "title": "What was found in a measured trace",
            "interface": {
                "mean_real_contact_area": f"{found['mean_real_contact_area'].value:.6g} um^2",
                "mean_junction_count": json.loads(f"{count:.6g}"),
                "calibration": "matched",
            },
            "diameter": sizes,
            "strength": strength,
            "pulse": {key: value for key, value in pulse.items() if value not in {"lens", "none"}},
            "sliding": ({} if self.speed is None else {"speed": f"{self.speed:.6g} um/s"})
            | {"distance": f"{signal.tick * signal.values.size:.6g} um"},
            "output": {"tick": f"{signal.tick:.6g} um"},
            "run": {"engine": "batch"},
        }
        about = "# What `rubnoise infer` found. Values are estimates; `infer` prints their intervals.\n"
        return about + text_of({name: value for name, value in keys.items() if value})

    @property
    def scenario(self) -> "Scenario":
        """The scenario that simulates what was found; raises Refused as `to_toml` does."""
        from rubnoise.scenario import loads

        return loads(self.to_toml(), f"found in {self.name}")

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Write this scenario into a file, and return its path; ``force`` allows an existing file to be replaced."""
        return _written(path, self.to_toml(), force=force)

    def report(self, path: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Write a page with pictures and tests, and return its path; raises Refused if nothing was found."""
        from rubnoise.figures.fits import fit_page

        self._found("report")
        return _written(path, fit_page(self, self.name, self.summary()), force=force)

    def plot(self) -> "Figure":
        """Draw trace, spectrum, residuals, autocorrelation and histogram; raises Refused if nothing was found."""
        from rubnoise.figures.fits import fit_figure

        self._found("draw")
        return fit_figure(self)

    def _found(self, what_for: str) -> Fit:
        if self.fit is None or self.refused_because is not None:
            raise Refused(f"{self.name}: there is nothing to {what_for}: {self.refused_because}")
        return self.fit

    def summary(self) -> str:
        """Return the whole answer as text."""
        return self.answer.to_text()

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """Return each estimate by its name: value, standard error, both ends of the 95 % interval, unit."""
        names = ("value", "standard_error", "low", "high", "unit")
        found = {name: (e.value, e.standard_error, *e.interval, e.unit) for name, e in self.estimates.items()}
        return {name: dict(zip(names, values, strict=True)) for name, values in found.items()}

    def to_pandas(self) -> "DataFrame":
        """Return the estimates as a DataFrame whose index is the quantity; else raises ExtraMissing."""
        with needing("analysis", "to_pandas"):
            import pandas as pd  # type: ignore[import-untyped]
        return pd.DataFrame.from_dict(self.to_dict(), orient="index").rename_axis("quantity")

    @property
    def answer(self) -> Answer:
        """The answer to what stands behind the trace: estimates, assumptions, tests, and the other laws and pulses.

        It fails if the trace says too little, or fails a test.
        """
        signal = self.signal
        title = f"{self.name}: {signal.values.size:,} samples over {signal.tick * signal.values.size:.4g} um of sliding"
        notes = (*signal.left_out, *signal.notes)
        if self.refused_because is not None:
            refused = Row(name="refused", value=self.refused_because, fails=True)
            return Answer(title=title, rows=(refused,), notes=notes, judged="the trace shows its junctions")
        rows = (*_estimates(self), *_granted(self), *_tests(self))
        judged = "the trace follows the model"
        return Answer(title=title, rows=rows, tables=tuple(_tables(self)), notes=notes, judged=judged)

    def __repr__(self) -> str:
        return shortened(self.summary().splitlines())

    def _repr_html_(self) -> str:
        return self.answer._repr_html_()


def _written(path: str | os.PathLike[str], text: str, *, force: bool) -> Path:
    with whole_file(path, force=force) as part:
        part.write_text(text, encoding="utf-8")
    return Path(path)


LAW_FREE_UNITS: Final = {"effective_diameter": "um"}
"""Units of what needs no law: m6/m5, and the number if sizes were equal."""


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
    for name, each in ((name, estimates[name]) for name in NAMES if name in estimates):
        unit, error = each.unit.strip("1"), each.standard_error
        yield Row(part=part, name=name, value=each.value, unit=unit, error=error, interval=each.interval)


def _granted(found: InferenceResult) -> Iterator[Row]:
    """Yield the assumptions, and what other passes and lives would give."""
    for name, words in found.assumptions.items():
        yield Row(part="assumptions", name=name, note=words)
    if (passes := found.other_offset) is not None:
        where = 'off the centre (offset="uniform")' if passes.pulse.offset == "uniform" else "through the centre"
        yield Row(part="assumptions", name="other_passes", note=f"{where} {_compared(passes)}")
    if (lives := found.other_shape) is not None:
        yield Row(part="assumptions", name="other_lives", note=f"of the shape {lives.pulse.shape} {_compared(lives)}")


def _compared(other: Tried) -> str:
    which, size = ("worse" if other.worse_by >= 0.0 else "better"), ("more" if other.diameter_off >= 0.0 else "less")
    told = "" if other.told_apart else ", which decides nothing"
    numbers = [
        f"{name} {shown(float(f'{each.value:.4g}'), each.unit.strip('1'))}"
        for name, each in other.estimates.items()
        if name in {"junction_count", "shear_strength"}
    ]
    diameter = f"diameter {other.estimates['diameter'].value:.4g} um ({100.0 * abs(other.diameter_off):.2g} % {size})"
    fit = f"fit {which} by {abs(other.worse_by):.3g} +- {other.error:.2g} of the criterion{told}"
    return f"{fit}, and give {', '.join([diameter, *numbers])}"


def _tests(found: InferenceResult) -> Iterator[Row]:
    """Yield the probability of each test's statistic if the model is right, and a doubt of the shape of lives."""
    for test in found.tests:
        yield Row(part="tests", name=test.name.replace(" ", "_"), value=test.p, note=test.words, fails=test.flagged)
    for words in found.flags[sum(test.flagged for test in found.tests) :]:
        yield Row(part="tests", name="shape_of_lives", value="open", note=words, fails=True)


def _tables(found: InferenceResult) -> Iterator[Table]:
    """Yield how number and strength depend on the spread of strengths, what else was fitted, and the statistics."""
    if found.by_strength_spread:
        columns = _columns(found.by_strength_spread, "strength_spread junction_count shear_strength")
        told = {name: values for name, values in columns.items() if values[0] is not None}
        yield Table(name="by_strength_spread", columns=told, units={"shear_strength": "MPa"})
    of_laws, pulses = "law criterion worse_by error told_apart", filter(None, (found.other_offset, found.other_shape))
    yield Table(name="laws", columns=_columns(found.laws, of_laws) | _estimated(found.laws), shown=())
    if tried := list(pulses):
        columns = _columns(tried, "pulse.shape pulse.offset worse_by error told_apart diameter_off")
        yield Table(name="pulses", columns=columns | _estimated(tried), shown=())
    yield Table(name="statistics", columns=_columns(found.tests, "name statistic level"), shown=())


_CALLED: Final = {"error": "worse_by_error", "pulse.shape": "shape", "pulse.offset": "offset"}
"""Names of columns that differ from the names of the attributes in them."""


def _columns(things: Sequence[Any], attributes: str) -> dict[str, list[Any]]:
    return {_CALLED.get(name, name): list(map(attrgetter(name), things)) for name in attributes.split()}


def _estimated(tried: Sequence[Tried]) -> dict[str, list[Any]]:
    """Return the columns of estimates that any of several fits has, with their errors."""
    columns = {}
    for name in (name for name in NAMES if any(name in each.estimates for each in tried)):
        known = [each.estimates.get(name) for each in tried]
        columns[name] = [None if each is None else each.value for each in known]
        columns[f"{name}_error"] = [None if each is None else each.standard_error for each in known]
    return columns
