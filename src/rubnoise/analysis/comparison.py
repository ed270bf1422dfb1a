"""Compare a run with the theory of its scenario: only its stored rows count, and no figure that it has stored.

`PARTS` lists what yields the figures of each part of a run, from what `measured` sums up.
"""

from collections.abc import Callable, Iterator, Mapping
from math import inf
from typing import Final

import numpy as np

from rubnoise.analysis import findings
from rubnoise.analysis.births import births, marks, scattered, start, sums
from rubnoise.analysis.figures import AREA, BORNE, COUNT, FORCE, GAP, PLACE, RISE, RUBBED, SPEED, moments, motion_of
from rubnoise.analysis.findings import LARGEST_ERROR, LARGEST_TAIL_SKEWNESS
from rubnoise.analysis.measured import STRETCHES, UNITS, MeasuredRun, measured_run
from rubnoise.analysis.moments import FEWEST_DECAYS, covariance_errors, decay, needed_for_mean, over_ticks
from rubnoise.analysis.motion import Balance
from rubnoise.analysis.records import longer
from rubnoise.analysis.run_summary import FEWEST_TICKS_A_LIFE
from rubnoise.analysis.spectra import Band, band_powers, half_of
from rubnoise.answer import Row, left_out
from rubnoise.contact.distributions import Fixed
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.model import FreeSeparation, Model
from rubnoise.record.rows import Rows
from rubnoise.theory.moments import area_cumulants, distribution, force_cumulants, zero_share
from rubnoise.theory.sampling import expected_periodogram, hann, mean_force_error
from rubnoise.theory.second_order import area_noise, autocovariance, need_random_births

BANDS, FEWEST_SEGMENTS = 8, 8
SMALLEST_ATOM: Final = 1e-3
"""Probability of no contact up to which it is but a step in the distribution that nothing is said of."""

_STEP_ERROR: Final = 1e-9
"""Error of a two-way motion's integrals over the largest work; that of rounding is far smaller."""

RELATION_ROUNDING: Final = 2.0**-40  # what rounding makes at most of a relation between columns, over its largest value


def area(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the moments of real contact area, or a relation if regular births keep it constant."""
    expected, found = area_cumulants(seen.model), seen.moments[AREA]
    if expected.variance == 0.0:
        away = max(abs(found.mean - expected.mean), found.std)
        yield findings.identity("real_contact_area", away, 1e-9 * expected.mean, "um^2")
    else:
        yield from moments(seen, AREA)


def force(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the moments of the friction force; with one strength it is psi A_r tick by tick."""
    if not isinstance(seen.model.strengths, Fixed):
        yield from moments(seen, FORCE)


def relations(seen: MeasuredRun) -> Iterator[Row]:
    """Yield how far columns are at most from what others make of them (see `measured.relations`)."""
    for name, (away, largest) in seen.off.items():
        yield findings.identity(name, away, RELATION_ROUNDING * largest, UNITS[name])


def memory(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the autocovariance at shares of a mean life; raises Refused unless births are random.

    It is taken about the mean of the record, which makes it smaller by the variance of that mean.
    """
    model, stretch, length = _stretch(seen, "the error of an autocovariance")
    lags = seen.noise.lags
    exact = autocovariance(model, lags) - area_noise(stretch).variance_of_mean()
    errors, found = covariance_errors(model, lags, length, seen.noise.step), seen.noise.products.covariances()
    scale, tail = float(autocovariance(model, np.zeros(1))[0]), findings.tail_of(model, length, 5)
    for lag, *values in zip(lags.tolist(), found.tolist(), exact.tolist(), errors.tolist(), strict=True):
        name = f"real_contact_area_autocovariance_{lag:.3g}"
        yield findings.judged(name, *values, length=length, scale=scale, tail=tail, unit="um^4")


def spectrum(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the power of eight bands of wavenumber beside that of an estimate, aliases and leakage included.

    Raises Refused unless births are random.
    """
    model, _, length = _stretch(seen, "the error of a spectrum")
    found, step = seen.noise.spectrum.spectrum(), seen.noise.step
    if found.segments < FEWEST_SEGMENTS:
        ticks = found.ticks + (FEWEST_SEGMENTS - 1) * half_of(found.ticks)
        findings.need(0.0, seen.first["trace"] * model.tick + step * ticks)
    _, expected = expected_periodogram(model, step, hann(found.ticks))
    # A life's energy |A^(k)|^2 goes with d^6 while a wave is longer than it, and with d^2 beyond.
    tails = {power: findings.tail_of(model, length, power) for power in (2, 6)}
    for band in band_powers(model, found, expected, length, BANDS):
        name = f"spectrum_{band.lowest:.3g}_to_{band.highest:.3g}"
        tail = _band_tail(model, band, tails[6 if band.lowest * model.calibrated_diameter < np.pi else 2], length)
        values = band.observed, band.expected, band.standard_error
        yield findings.judged(name, *values, length=length, tail=tail, unit="um^4")


def _band_tail(model: Model, band: Band, of_sizes: findings.Tail, length: float) -> findings.Tail:
    """Return the tail of a band's power: off the centre line a few lives with a sharp tip have most short waves."""
    sharp = 0.0 if model.pulse.offset == "none" else band.skewness
    needed = max(of_sizes.needed, longer(length, sharp, LARGEST_TAIL_SKEWNESS))
    return findings.Tail(skewness=max(of_sizes.skewness, sharp), needed=needed)


def _stretch(seen: MeasuredRun, wanted: str = "") -> tuple[Model, Model, float]:
    """Return the model, that of the stationary part of the trace, and the length of this in um.

    ``wanted`` names an error that is known for births at random and fine ticks alone; raises Refused without these.
    """
    model, ticks = seen.model, seen.ticks()
    if wanted:
        need_random_births(model, wanted)
        if model.mean_life_distance < FEWEST_TICKS_A_LIFE * model.tick:
            raise Refused(f"ticks are too wide for it; it needs {FEWEST_TICKS_A_LIFE} to a mean life")
    return model, over_ticks(model, ticks), ticks * model.tick


def law_of_area(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the share of ticks without contact, and the distance of the areas in contact from their distribution.

    The atom and the continuous part have a figure each. Raises Refused if theory has none.
    """
    exact, share = distribution(seen.model), _zero_share(seen)
    atom = exact.atom_at_zero
    if share.value is not None or atom > SMALLEST_ATOM:
        yield share
    # Ticks farther apart than the longest life share no junction: their areas are independent.
    first = seen.first["trace"]
    areas, counts, _ = seen.sampled[:, first // seen.apart :]
    sample = findings.UniformSample()
    sample.add((np.asarray(exact.cdf(areas[counts > 0]), dtype=np.float64) - atom) / (1.0 - atom))
    needed = (first + seen.apart * findings.FEWEST / (1.0 - atom)) * seen.model.tick
    yield findings.kolmogorov_figure("real_contact_area_kolmogorov", sample, needed)


def _zero_share(seen: MeasuredRun) -> Row:
    """Return the share of ticks at which no junction is alive, all ticks of the stationary part."""
    _, stretch, length = _stretch(seen)
    (exact, error, skewness), name = zero_share(stretch), "junction_count_zero_share"
    relative = error / min(exact, 1.0 - exact) if error else inf
    needed = max(longer(length, relative, LARGEST_ERROR), longer(length, skewness, LARGEST_TAIL_SKEWNESS))
    tail = findings.Tail(skewness=skewness, needed=needed)
    value = seen.zero_ticks / seen.ticks()
    return findings.judged(name, value, exact, error, length=length, skewness=0.0, tail=tail)


# The motion.
def balance(seen: MeasuredRun) -> Iterator[Row]:
    """Yield what a two-way slider's balance of energy lacks: 0, but for the error of its steps and rounding."""
    if seen.model.is_two_way and seen.last:
        found = Balance.of(seen.model, seen.last)
        away = abs(found.energy_residual) * found.scale
        yield findings.identity("energy", away, _STEP_ERROR * found.scale, "uN um")


def mean_force(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the mean force over time beside its law, int G ds being what Campbell's theorem expects of it.

    <F> = (E[F] s + c int x'^2 dt + 2 int_(w < 0) G |ds| + [E])/(V T); int G ds has the standard error s sqrt(S_F(0)/s),
    exact for every length. Raises Refused unless births are random.
    """
    model = seen.model
    if not (model.is_two_way and seen.last) or model.start != "stationary":
        return
    need_random_births(model, "the standard error of a mean force")
    findings.need(model.distance, needed_for_mean(model))
    found = Balance.of(model, seen.last)
    share = found.distance / (found.speed * found.time)
    expected = force_cumulants(model).mean * share + found.expected_excess()
    error, tail = mean_force_error(model, model.distance) * share, findings.tail_of(model, model.distance, 3, 1)
    yield findings.judged(
        "mean_force", found.mean_force, expected, error, length=model.distance, skewness=0.0, tail=tail, unit="uN"
    )


def motion(seen: MeasuredRun) -> Iterator[Row]:
    """Yield mean and std of displacement and std of velocity.

    For a two-way slider the figures are known if coupling is weak. Raises Refused if theory has no motion for the
    model, or no errors.
    """
    model = seen.model
    if model.slider is None:
        return
    motion_of(model)
    if model.slider.damping == 0.0:
        raise Refused("a slider without damping never forgets its start")
    _need_motion(seen, "slider")
    yield from moments(seen, PLACE, SPEED)


def _need_motion(seen: MeasuredRun, group: str) -> None:
    """Raise Refused if a record is too short for the moments of a motion, after its start is forgotten."""
    needed = max(FEWEST_DECAYS * decay(seen.model, group), needed_for_mean(seen.model))
    findings.need(seen.model.distance, seen.first[group] * seen.model.tick + needed)


def load(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the moments of the motion under a load, and of load and force."""
    if seen.model.separation is not None:
        _need_motion(seen, "load")
        yield from moments(seen, GAP, RISE, BORNE, RUBBED)


def flight(seen: MeasuredRun, free: FreeSeparation) -> Iterator[Row]:
    """Yield the exact relations of free motion: e^2 H A <= P <= H A with a restitution e, F = psi A, and momentum.

    The mean of P, less the momentum m [z'] + c [z] that a stretch has gained, is W, and that of an elastic contact H A.
    The sum of P over ticks differs from its integral by an error of mean 0, since events fall anywhere between them.
    """
    held, found, step = free.held, seen.stretches, seen.model.tick_duration or 1.0
    yield from relations(seen)
    if not found or found["load"].length < 2 * STRETCHES:
        yield findings.too_short("load_mean", 2 * STRETCHES**2 * seen.model.tick)
        return
    gained = (held.mass * found["velocity"].gained + held.damping * found["separation"].gained) / step
    yield scattered("load_mean", found["load"].means - gained, held.load, "uN")
    if free.restitution == 1.0:
        means = found["real_contact_area"].means - gained / held.hardness
        yield scattered("real_contact_area_mean", means, seen.model.mean_real_contact_area, "um^2")


Producer = Callable[[MeasuredRun], Iterator[Row]]

PARTS: Final[dict[str, tuple[str, dict[str, Producer]]]] = {
    "births": ("", {"birth": births, "start": start}),
    "junctions": ("", {"diameter": marks, "life": sums}),
    "contact": (
        "trace",
        {
            "real_contact_area": area,
            "real_contact_area_kolmogorov": law_of_area,
            "junction_count": lambda seen: moments(seen, COUNT),
            "friction_force": force,
            "real_contact_area_autocovariance": memory,
            "spectrum": spectrum,
        },
    ),
    "balance": ("", {"balance": balance, "mean_force": mean_force}),
    "slider": ("slider", {"displacement": motion}),
    "load": ("load", {"load": load}),
    "identities": ("", {"relations": relations}),
}
"""The parts of a comparison: the group in which its record begins, and what yields its figures, by name."""


def compare(model: Model, rows: Rows, bound: float | None = None) -> findings.Comparison:
    """Return the comparison of a run with theory; ``bound`` replaces the family-wise bound on |z|.

    Only stored rows count, and no figure that the run has stored. They are read once, in chunks. Raises Refused, with
    the length that it needs, for a run too short even for a score of its mean area, RunFileRefused for damaged rows.
    """
    seen = measured_run(model, rows)
    if model.free is not None:
        silent = "free motion has no theory of its spreads, its shocks and its touches"
        found = (*flight(seen, model.free), left_out("everything else", silent))
        return findings.comparison({"load": found}, {"load": 0.0}, bound)
    first, needed = seen.first["trace"] * model.tick, needed_for_mean(model)
    if seen.ticks() * model.tick < needed:
        short = f"{(model.tick_count + 1) * model.tick:.6g} um of sliding are too short for it"
        raise Refused(f"a comparison with the theory: {short}; it needs about {first + needed:.3g} um")
    begins = {heading: seen.first.get(group, 0) * model.tick for heading, (group, _) in PARTS.items()}
    return findings.comparison(
        {heading: _found(seen, producers) for heading, (_, producers) in PARTS.items()}, begins, bound
    )


def _found(seen: MeasuredRun, producers: Mapping[str, Producer]) -> list[Row]:
    """Return the findings of a part; of a figure that theory refuses, its name and the reason."""
    found: list[Row] = []
    for name, produce in producers.items():
        try:
            found += produce(seen)
        except RunFileRefused:
            raise
        except Refused as refusal:
            found.append(left_out(name, str(refusal)))
    return found
