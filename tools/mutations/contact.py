"""Faults of the laws of births, sizes and strengths, of the calibration and of the life of one junction."""

from __future__ import annotations

from mutations.mutant import Edit, Mutant, one

MOMENTS = "test_births_count_and_area_of_one_size"
NEWBORN = "test_diameters_of_newborns"
STRENGTHS = "test_every_strength_is_the_one_that_was_given[batch]"

_POISSON_GAP = "gaps *= self.mean_spacing"
_NEWBORN = "values = normal_above(uniform, self._positive_mass) values *= self.std values += self.centre"

BIRTHS = (
    one("births 1 % too rare", MOMENTS, _POISSON_GAP, f"{_POISSON_GAP} * 1.01", chance=True),
    one("births 1 % too many", MOMENTS, _POISSON_GAP, f"{_POISSON_GAP} * 0.99", chance=True),
    one("regular gaps", MOMENTS, _POISSON_GAP, "gaps[:] = self.mean_spacing", chance=True),
    one("uniform gaps", MOMENTS, _POISSON_GAP, "gaps = 2.0 * self.mean_spacing * uniform", chance=True),
    one(
        "gap from d instead of 2d",
        MOMENTS,
        "mean_spacing=pulse.mean_life * diameter / interface.mean_junction_count",
        "mean_spacing=diameter / interface.mean_junction_count",
        chance=True,
    ),
    one(
        "regular births begin with the run",
        "test_the_start_of_regular_births_is_stationary",
        "return self.mean_spacing * uniform",
        "return 0.0 * uniform",
    ),
)

SIZES = (
    one(
        "spread 5 % too wide",
        f"{NEWBORN}[0.2 um]",
        _NEWBORN,
        "values = normal_above(uniform, self._positive_mass)\nvalues *= 1.05 * self.std\nvalues += self.centre",
        chance=True,
    ),
    one(
        "absolute spread taken as relative",
        f"{NEWBORN}[0.2 um]",
        "if self.relative is not None else self.absolute or 0.0",
        "if self.relative is not None else (self.absolute or 0.0) * centre",
        chance=True,
    ),
    one(
        "relative spread taken as absolute",
        f"{NEWBORN}[20 %]",
        "return self.relative * centre if",
        "return self.relative if",
        chance=True,
    ),
    one(
        "abs(d) for redraw",
        f"{NEWBORN}[120 %]",
        _NEWBORN,
        "values = np.abs(self.centre + self.std * normal_above(uniform, 1.0))",
        chance=True,
    ),
    one(
        "normal deviates not conditioned",
        "test_normal_above_lies_above_its_bound",
        "above *= mass_above",
        "",
    ),
    one(
        "lognormal lives not length-biased",
        "test_live_junctions_weigh_by_diameter",
        "moved = median * (1.0 + (self.std / self.mean) * (self.std / self.mean))",
        "moved = median",
    ),
    one(
        "gamma moments a step too far",
        "test_moments_are_those_of_the_density",
        "moment *= mean + n * std**2 / mean",
        "moment *= mean + (n + 1) * std**2 / mean",
    ),
    one(
        "live power sizes as they are born",
        "test_live_junctions_weigh_by_diameter",
        "Power(exponent=self.exponent - 1.0,",
        "Power(exponent=self.exponent,",
    ),
    one(
        "power sizes of the logarithmic case alone",
        "test_samples_follow_the_law",
        "if growth == 0.0:",
        "if growth != 0.0:",
    ),
    one(
        "ends of a range in any order",
        "test_the_ends_of_a_range_have_an_order[0.2]",
        "and most <= least:",
        "and most < 0.0 * least:",
    ),
)

STRENGTH_LAWS = (
    one(
        "strengths in Pa",
        STRENGTHS,
        "law_for(float(strength.mean)",
        "law_for(1e6 * float(strength.mean)",
    ),
    one(
        "Weibull strengths all exponential",
        "test_laws.py::test_samples_have_the_exact_moments",
        "return scale * antilogarithm(exponent * logarithm(deviate))",
        "return scale * deviate",
    ),
)

CALIBRATION = (
    one(
        "0.327 for 1/3",
        MOMENTS,
        "return mpmath.mpf(1) / 3",
        'return mpmath.mpf("0.327")',
        chance=True,
    ),
    one(
        "the smaller root matched",
        "test_matched_takes_the_larger_root",
        "(turning, mpmath.sqrt(wanted) / std),",
        '(mpmath.mpf("0.01"), turning),',
    ),
)

PULSES = (
    one(
        "triangle of the same peak",
        MOMENTS,
        'return PULSES[pulse.shape] if pulse.offset == "none" else OFF_CENTRE_LENS',
        'return PULSES["triangle"]',
        chance=True,
    ),
    Mutant(
        "triangle of the same mean",
        (
            Edit(
                'return PULSES[pulse.shape] if pulse.offset == "none" else OFF_CENTRE_LENS',
                'return PULSES["triangle"]',
            ),
            Edit("_SLOPE = 0.25 * np.pi", "_SLOPE = 2.0 / 3.0"),
        ),
        MOMENTS,
        chance=True,
    ),
    one(
        "second term of a single life 2 % off",
        "test_area_is_that_of_two_segments",
        "- x * np.sqrt((d - x) * (d + x))",
        "- 1.02 * x * np.sqrt((d - x) * (d + x))",
    ),
    one(
        "integrals of triangles as of parabolas",
        "test_triangles_have_the_cumulants_of_a_uniform_area",
        "return 2.0 * (0.25 * pi) ** power / (power + 1.0)",
        "return 2.0 * (0.25 * pi) ** power / (power + 2.0)",
    ),
    one(
        "offsets that no scenario brings along",
        "test_a_scenario_has_its_exact_theory_by_python_and_by_the_command",
        'return PULSES[pulse.shape] if pulse.offset == "none" else OFF_CENTRE_LENS',
        "return PULSES[pulse.shape]",
    ),
    one(
        "lives off the centre line as long as centred ones",
        "test_life_integrals_are_those_of_the_reference",
        "return np.pi / 2.0",
        "return 2.0",
    ),
    one(
        "offsets all over the disc as of one line",
        "test_life_integrals_are_those_of_the_reference",
        "np.pi * np.sum(weights * np.sin(y) * np.cos(y) * _overlap_at(y) ** power)",
        "np.pi * np.sum(weights * np.sin(y) * _overlap_at(y) ** power)",
    ),
)

MUTANTS = (*BIRTHS, *SIZES, *STRENGTH_LAWS, *CALIBRATION, *PULSES)
