"""What theory says about a model, as lines for a terminal and as rows of a table."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np

from rubnoise.cli.coupling import coupling_lines
from rubnoise.cli.layout import ONE_WAY_ALONE, line, number, printable, remark
from rubnoise.cli.terminal import sentence

COLUMN: Final = 19
LINES_SHOWN: Final = 6
BINS_SHOWN: Final = 8
GUIDE_SKEWNESS: Final = 0.45
"""Of the displacement: up to there the series for passages was compared with the exact law."""

UNITS: Final = {
    "area.mean": "um^2",
    "area.std": "um^2",
    "force.mean": "uN",
    "force.std": "uN",
    "slider.displacement_mean": "um",
    "slider.displacement_std": "um",
    "slider.velocity_std": "um/s",
    "diameter.calibrated": "um",
    "diameter.mean": "um",
    "diameter.length_biased_mean": "um",
    "spectrum.wavenumber": "rad/um",
    "spectrum.density": "um^4/(rad/um)",
    "spectral_lines.wavenumber": "rad/um",
    "spectral_lines.power": "um^4",
    "autocovariance.lag": "um",
    "autocovariance.value": "um^4",
    "estimated_spectrum.wavenumber": "rad/um",
    "estimated_spectrum.density": "um^4/(rad/um)",
    "estimated_spectrum.standard_error": "um^4/(rad/um)",
    "crossings.level": "um",
    "crossings.rate": "1/s",
    "crossings.gaussian_rate": "1/s",
    "from_empty.distance": "um",
    "from_empty.area_mean": "um^2",
    "from_empty.run_area_mean": "um^2",
    "distribution.area": "um^2",
    "distribution.density": "1/um^2",
}
"""Units by the path of a field; what is not here is a plain number, but for cumulants, each of its own unit."""

CURVES: Final = {
    "spectrum": "wavenumber",
    "spectral_lines": "wavenumber",
    "autocovariance": "lag",
    "distribution": "area",
    "estimated_spectrum": "wavenumber",
    "crossings": "level",
    "from_empty": "distance",
}
"""Groups that are told at points, and which of their fields says where."""


def described(heading: str, calibration: str, answer: dict[str, Any], *, two_way: bool) -> list[str]:
    """Return what theory says, as lines to print under a heading."""
    return [
        sentence(printable(heading)),
        "",
        *_moment_lines(calibration, answer),
        *_slider_lines(answer.get("slider"), two_way=two_way),
        *_curve_lines(answer),
    ]


def _moment_lines(calibration: str, answer: dict[str, Any]) -> Iterator[str]:
    count, sizes = answer["count"], answer["diameter"]
    yield line("mean diameter d_m", f"{_shown(sizes['calibrated'])} um (calibration {calibration})")
    yield line("diameters as drawn", f"mean {_shown(sizes['mean'])} um")
    yield line("of those found alive", f"mean {_shown(sizes['length_biased_mean'])} um")
    yield line("junction count", f"mean {_shown(count['mean'])}, variance {_shown(count['variance'])}")
    for name, label, unit in (("area", "real contact area", "um^2"), ("force", "friction force", "uN")):
        if name in answer:
            yield from _cumulant_lines(label, unit, answer[name])


def _cumulant_lines(label: str, unit: str, group: dict[str, Any]) -> Iterator[str]:
    yield line(label, f"mean {_shown(group['mean'])}, std {_shown(group['std'])} {unit}")
    yield line("", f"skewness {_shown(group['skewness'])}, excess kurtosis {_shown(group['excess_kurtosis'])}")


def _slider_lines(slider: dict[str, Any] | None, *, two_way: bool) -> Iterator[str]:
    if slider is None:
        return
    place = f"mean {_shown(slider['displacement_mean'])}, std {_shown(slider['displacement_std'])} um"
    yield line("displacement", place)
    yield line("velocity", f"std {_shown(slider['velocity_std'])} um/s")
    yield from coupling_lines(slider, two_way=two_way)
    if two_way:
        yield remark(f"note: {ONE_WAY_ALONE}")


def _curve_lines(answer: dict[str, Any]) -> Iterator[str]:
    spectrum, covariance, law = answer["spectrum"], answer["autocovariance"], answer.get("distribution")
    yield from _table(
        "spectral density of the area, two-sided",
        {"k (rad/um)": spectrum["wavenumber"], "S (um^4/(rad/um))": spectrum["density"]},
    )
    if "spectral_lines" in answer:
        k, power = (answer["spectral_lines"][name][:LINES_SHOWN] for name in ("wavenumber", "power"))
        yield from _table("and the first of its lines", {"k (rad/um)": k, "power (um^4)": power})
    yield from _table("autocovariance of the area", {"lag (um)": covariance["lag"], "R (um^4)": covariance["value"]})
    yield from _estimated_lines(answer.get("estimated_spectrum"))
    yield from _crossing_lines(answer.get("crossings"))
    yield from _growth_lines(answer.get("from_empty"))
    if law is not None:
        yield from _table(
            f"distribution of the area, which is 0 with probability {_shown(law['atom_at_zero'])}",
            {"area (um^2)": law["area"], "density (1/um^2)": law["density"], "P(A_r <= area)": law["cdf"]},
        )


def _estimated_lines(seen: dict[str, Any] | None) -> Iterator[str]:
    """Yield some of the bins of an estimate, evenly spaced in the logarithm of the wavenumber."""
    if seen is None:
        return
    bins = len(seen["wavenumber"])
    shown = sorted({0, *(round(each) for each in np.geomspace(1, bins - 1, BINS_SHOWN))})
    columns = {"k (rad/um)": "wavenumber", "S (um^4/(rad/um))": "density", "std error": "standard_error"}
    cut = f"{seen['segments']} segments of {seen['ticks']} ticks"
    yield from _table(
        f"what Welch's method shows with {cut}; {len(shown)} of {bins} bins",
        {label: [seen[name][n] for n in shown] for label, name in columns.items() if name in seen},
    )


def _crossing_lines(passed: dict[str, Any] | None) -> Iterator[str]:
    if passed is None:
        return
    skewness = passed["displacement_skewness"]
    yield from _table(
        f"passages of the displacement upwards, whose skewness is {_shown(skewness)}",
        {"level (um)": passed["level"], "rate (1/s)": passed["rate"], "if Gaussian (1/s)": passed["gaussian_rate"]},
    )
    if abs(skewness) > GUIDE_SKEWNESS:
        yield remark(f"note: beyond a skewness of {GUIDE_SKEWNESS} these rates are a guide alone")


def _growth_lines(grown: dict[str, Any] | None) -> Iterator[str]:
    if grown is None:
        return
    over = f"{_shown(grown['run_area_mean'])} um^2 and {_shown(grown['run_count_mean'])} junctions"
    yield from _table(
        f"means after an empty start; over the whole run {over}",
        {"distance (um)": grown["distance"], "area (um^2)": grown["area_mean"], "junctions": grown["count_mean"]},
    )


def _table(heading: str, columns: dict[str, Sequence[float | None]]) -> Iterator[str]:
    yield from ("", sentence(heading))
    yield "  " + "".join(f"{name:>{COLUMN}}" for name in columns)
    for row in zip(*columns.values(), strict=True):
        yield "  " + "".join(f"{_shown(value):>{COLUMN}}" for value in row)


def _shown(value: float | None) -> str:
    return "none" if value is None else number(value)


def rows(answer: dict[str, Any]) -> Iterator[str]:
    """Return a heading and a row a number: its name, where it is taken and in which unit, its value and its unit.

    Numbers are to their last bit; a value that is not finite is left empty.
    """
    yield "quantity,at,at_unit,value,unit"
    for group, fields in answer.items():
        at = CURVES.get(group)
        for name, value in fields.items():
            path = f"{group}.{name}"
            if name == "cumulants":
                for order, each in enumerate(value, start=1):
                    yield _row(path, order, "order", each, _power(UNITS[f"{group}.mean"], order))
            elif isinstance(value, list) and name != at:
                for where, each in zip(fields[at], value, strict=True):
                    yield _row(path, where, UNITS[f"{group}.{at}"], each, UNITS.get(path, "1"))
            elif not isinstance(value, list | str):
                yield _row(path, "", "", value, UNITS.get(path, "1"))


def _power(unit: str, order: int) -> str:
    base, _, power = unit.partition("^")
    exponent = order * int(power or 1)
    return base if exponent == 1 else f"{base}^{exponent}"


def _row(*cells: Any) -> str:
    return ",".join("" if cell is None else str(cell) for cell in cells)
