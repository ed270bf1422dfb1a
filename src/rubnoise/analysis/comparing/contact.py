"""Compare the moments of area, count and force over the stationary part of the trace with theory."""

from math import sqrt

import numpy as np

from rubnoise.analysis.comparing.findings import Finding, Identity, judged, judged_mean, tail_of, too_short
from rubnoise.analysis.comparing.trace import TraceSums
from rubnoise.analysis.moments import needed_for_mean, over_ticks
from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.theory.cumulants import Cumulants, area_cumulants, force_cumulants
from rubnoise.theory.live_count import count_covariance, mean_count, mean_count_error
from rubnoise.theory.sampling import mean_area_error, mean_force_error, standard_errors
from rubnoise.theory.second_order import are_at_random, autocovariance, joint_cumulant, lag_rule, need_random_births

_ROUNDING = 2.0**-50
_CONSTANT = 1e-9


def stationary_length(model: Model, trace: TraceSums) -> float:
    """Return the length in um of the stationary part of a trace."""
    return trace.stationary_ticks * model.tick


def missing_length(model: Model, trace: TraceSums) -> float | None:
    """Return the sliding distance in um that a mean needs, or None if the trace is long enough."""
    needed = needed_for_mean(model)
    return None if stationary_length(model, trace) >= needed else trace.layout.stationary_from * model.tick + needed


def area_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return the four moments of real contact area, or an identity if regular births keep it constant.

    Raises Refused if theory has no errors for its births.
    """
    expected, seen, length = area_cumulants(model), trace.area, stationary_length(model, trace)
    if expected.variance == 0.0:
        away, allowed = max(abs(seen.mean - expected.mean), seen.std), _CONSTANT * expected.mean
        return [Identity(name="real_contact_area", deviation=away, allowed=allowed, units="um^2")]
    if not are_at_random(model) and not isinstance(model.births, RegularBirths):
        return _second_order(model, trace, expected)
    need_random_births(model, "the standard error of a mean area")
    errors = standard_errors(over_ticks(model, trace.stationary_ticks, model.tick))
    # A junction brings d^(2n + 1) to the n-th power of the area.
    tails = {n: tail_of(model, length, 2 * n + 1) for n in range(1, 5)}
    return [
        judged_mean("real_contact_area_mean", seen.mean, expected.mean, errors.mean, length=length, tail=tails[1]),
        judged("real_contact_area_std", seen.std, expected.std, errors.std, length=length, tail=tails[2]),
        *(
            judged(
                f"real_contact_area_{name}",
                getattr(seen, name),
                getattr(expected, name),
                getattr(errors, name),
                length=length,
                scale=1.0,
                tail=tails[n],
            )
            for n, name in ((3, "skewness"), (4, "excess_kurtosis"))
        ),
    ]


def _second_order(model: Model, trace: TraceSums, expected: Cumulants) -> list[Finding]:
    """Return mean and std of the area for births whose first two orders are known.

    Cov[z^2, z^2] = 2 R^2 of a normal contact with the covariance R, plus the part of single junctions, times the cube
    of the dispersion if births come in bunches, as fourth cumulants of a bunch grow.
    """
    stretch, length = over_ticks(model, trace.stationary_ticks, model.tick), stationary_length(model, trace)
    seen, tails = trace.area, [tail_of(model, length, power) for power in (3, 5)]
    lags, weights = lag_rule(stretch)
    bunched = max(model.births.dispersion, 1.0) ** 3
    fourth = bunched * joint_cumulant(stretch, lags, 2, 2)
    error = sqrt(float(weights @ (fourth + 2.0 * np.square(autocovariance(stretch, lags)))))
    mean_error, std_error = mean_area_error(stretch), error / (2.0 * expected.std)
    return [
        judged_mean("real_contact_area_mean", seen.mean, expected.mean, mean_error, length=length, tail=tails[0]),
        judged("real_contact_area_std", seen.std, expected.std, std_error, length=length, tail=tails[1]),
    ]


def count_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return mean and variance of the live count; raises Refused unless it is Poisson.

    The variance of the mean square about the mean follows from the joint cumulants of N(s) and N(s + tau), all of them
    C = lam E[(2d - tau)+]: Cov[(N - mean)^2, (N_tau - mean)^2] = C + 2 C^2.
    """
    need_random_births(model, "the standard error of a mean count")
    stretch = over_ticks(model, trace.stationary_ticks, model.tick)
    lags, weights = lag_rule(stretch)
    shared = count_covariance(model, lags)
    expected, seen = mean_count(model), trace.count
    error = sqrt(float(weights @ (shared + 2.0 * shared**2)))
    length = stationary_length(model, trace)
    tail = tail_of(model, length, 1)
    return [
        judged_mean("junction_count_mean", seen.mean, expected, mean_count_error(stretch), length=length, tail=tail),
        judged("junction_count_variance", seen.variance, expected, error, length=length, tail=tail),
    ]


def force_findings(model: Model, trace: TraceSums) -> list[Finding]:
    """Return the friction force beside its law: psi A_r tick by tick for one strength, else mean and std.

    Raises Refused for unequal strengths unless births are random.
    """
    if model.strengths is None or model.separation is not None:
        return []  # under a load that weighs it belongs to what is left of the load
    if isinstance(model.strengths, Fixed):
        largest = model.strengths.mean * (trace.area.mean + 12.0 * trace.area.std)
        away, allowed = trace.force_deviation, _ROUNDING * largest
        return [Identity(name="friction_force", deviation=away, allowed=allowed, units="uN")]
    need_random_births(model, "the standard error of a mean force")
    missing = missing_length(model, trace)
    return _unequal_strengths(model, trace) if missing is None else [too_short("friction_force", missing)]


def _unequal_strengths(model: Model, trace: TraceSums) -> list[Finding]:
    expected, seen = force_cumulants(model), trace.force
    stretch = over_ticks(model, trace.stationary_ticks, model.tick)
    length = stationary_length(model, trace)
    error = _variance_error(stretch) / (2.0 * expected.std)
    return [
        judged_mean(
            "friction_force_mean",
            seen.mean,
            expected.mean,
            mean_force_error(stretch),
            length=length,
            tail=tail_of(model, length, 3, 1),
        ),
        judged("friction_force_std", seen.std, expected.std, error, length=length, tail=tail_of(model, length, 5, 2)),
    ]


def _variance_error(stretch: Model) -> float:
    """Return the standard error in uN^2 of the force's variance: Cov = E[psi^4] kappa_22 + 2 (E[psi^2] kappa_11)^2."""
    if stretch.strengths is None:
        return 0.0
    lags, weights = lag_rule(stretch)
    second, fourth = stretch.strengths.moment(2), stretch.strengths.moment(4)
    return sqrt(
        float(
            weights
            @ (fourth * joint_cumulant(stretch, lags, 2, 2) + 2.0 * (second * autocovariance(stretch, lags)) ** 2)
        )
    )
