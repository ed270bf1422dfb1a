"""The faults that `tools/mutants.py` puts into a copy of the program, each with the test that has to notice it."""

from __future__ import annotations

from dataclasses import dataclass

_SENTINELS = "tests/verification/test_sentinels.py::"
_ROWS = "tests/verification/test_sentinel_rows.py::"

MOMENTS = f"{_SENTINELS}test_births_count_and_area_of_one_size"
NEWBORN = f"{_SENTINELS}test_diameters_of_newborns"
START = f"{_SENTINELS}test_who_is_alive_at_the_start"
STREAMS = f"{_SENTINELS}test_streams_and_blocks_are_independent"
BIRTHS = f"{_ROWS}test_births_are_those_that_the_streams_hold[events]"
LIVES = f"{_ROWS}test_every_life_lasts_two_diameters[batch]"
TICKS = f"{_ROWS}test_ticks_lie_at_multiples_of_the_tick[batch]"
STRENGTHS = f"{_ROWS}test_every_strength_is_the_one_that_was_given[batch]"
LENSES = f"{_ROWS}test_area_count_and_force_follow_from_the_rows[lenses-batch]"
UNEQUAL = f"{_ROWS}test_area_count_and_force_follow_from_the_rows[unequal strengths-batch]"
FINE_LENSES = f"{_ROWS}test_area_count_and_force_follow_from_the_rows[lenses, fine ticks-batch]"
MOTION = f"{_ROWS}test_the_motion_follows_from_the_rows[0.1 um-batch]"
OVERLAP = "tests/unit/test_overlap.py::test_area_is_that_of_two_segments"


@dataclass(frozen=True)
class Edit:
    """A text that stands exactly once in a file of src/rubnoise, and what stands there instead."""

    file: str
    old: str
    new: str


@dataclass(frozen=True)
class Mutant:
    """A fault by its name, the edits that make it, and the test that notices it.

    ``identity``: whether the test asks for equality to rounding; otherwise it has to show |z| >= 8.
    """

    name: str
    edits: tuple[Edit, ...]
    test: str
    identity: bool = False


def one(name: str, test: str, file: str, old: str, new: str, *, identity: bool = False) -> Mutant:
    """Return a mutant of a single edit."""
    return Mutant(name, (Edit(file, old, new),), test, identity)


_POISSON_GAP = "gaps *= self.mean_spacing"
_NEWBORN = """diameters = normal_above(uniform, self._positive_mass)
        diameters *= self.std
        diameters += self.mean
"""
_TICK = "float(first + n) * spacing"
_AREA = "total[tick] = fused(weight * (u * np.sqrt(u)), _horner(AREA_COEFFICIENTS, u), total[tick])"
_SECOND_TERM = "weight * (1.0 - u) * np.sqrt(u * (2.0 - u)) / 2.0"

LAWS = (
    one("0.327 for 1/3", MOMENTS, "contact/pulses.py", "return mpmath.mpf(1) / 3", 'return mpmath.mpf("0.327")'),
    one("births 1 % too rare", MOMENTS, "contact/births.py", _POISSON_GAP, f"{_POISSON_GAP} * 1.01"),
    one("births 1 % too many", MOMENTS, "contact/births.py", _POISSON_GAP, f"{_POISSON_GAP} * 0.99"),
    one("regular gaps", MOMENTS, "contact/births.py", _POISSON_GAP, "gaps[:] = self.mean_spacing"),
    one("uniform gaps", MOMENTS, "contact/births.py", _POISSON_GAP, "gaps = 2.0 * self.mean_spacing * uniform"),
    one(
        "gap from d instead of 2d",
        MOMENTS,
        "scenario/build.py",
        "mean_spacing=2.0 * diameter / interface.mean_junction_count",
        "mean_spacing=diameter / interface.mean_junction_count",
    ),
    one(
        "spread 5 % too wide",
        f"{NEWBORN}[0.2 um]",
        "contact/sizes.py",
        _NEWBORN,
        _NEWBORN.replace("self.std", "1.05 * self.std"),
    ),
    one(
        "absolute spread taken as relative",
        f"{NEWBORN}[0.2 um]",
        "contact/spread.py",
        "return self.absolute or 0.0",
        "return (self.absolute or 0.0) * mean_diameter",
    ),
    one(
        "relative spread taken as absolute",
        f"{NEWBORN}[20 %]",
        "contact/spread.py",
        "return self.fraction * mean_diameter",
        "return self.fraction",
    ),
    one(
        "abs(d) for redraw",
        f"{NEWBORN}[120 %]",
        "contact/sizes.py",
        _NEWBORN,
        "diameters = np.abs(self.mean + self.std * normal_above(uniform, 1.0))\n",
    ),
)

START_OF_A_RUN = (
    one(
        "empty start",
        START,
        "simulation/draws.py",
        'live = _stationary_rows(model, seed) if model.start == "stationary" else LiveRows.none()',
        "live = LiveRows.none()",
    ),
    one(
        "start sizes not length-biased",
        START,
        "contact/sizes.py",
        "return _accepted(lambda n: self.draw(generator.random(n)), generator, largest, count)",
        "return self.draw(generator.random(count))",
    ),
    one(
        "start count fixed",
        START,
        "simulation/draws.py",
        "count = _poisson(seed, 2.0 * model.birth_rate * model.sizes.moment(1))",
        "count = round(2.0 * model.birth_rate * model.sizes.moment(1))",
    ),
    one(
        "start ages of half a life",
        START,
        "simulation/draws.py",
        "birth = -(2.0 * diameter) * uniforms(",
        "birth = -diameter * uniforms(",
    ),
)

STREAM_USE = (
    one(
        "births and sizes on one stream",
        STREAMS,
        "streams.py",
        "key = np.array([seed, int(stream)], dtype=np.uint64)",
        "key = np.array([seed, 2 if stream == 3 else int(stream)], dtype=np.uint64)",
    ),
    Mutant(
        "a block's stream reused",
        (
            Edit("streams.py", "np.array([0, 0, block, 0], dtype", "np.array([0, 0, block // 2, 0], dtype"),
            Edit("streams.py", '["counter"][2] = number', '["counter"][2] = number // 2'),
        ),
        STREAMS,
    ),
    one(
        "first birth of a block dropped",
        BIRTHS,
        "simulation/draws.py",
        """        birth=birth[:count],
        gaps=gaps[:count],
        diameter=_drawn(model, seed, Stream.DIAMETERS, block, blocks)[:count],
        strength=_drawn(model, seed, Stream.STRENGTHS, block, blocks)[:count],
""",
        """        birth=birth[1:count],
        gaps=gaps[1:count],
        diameter=_drawn(model, seed, Stream.DIAMETERS, block, blocks)[1:count],
        strength=_drawn(model, seed, Stream.STRENGTHS, block, blocks)[1:count],
""",
        identity=True,
    ),
    one(
        "float32 births",
        BIRTHS,
        "simulation/draws.py",
        "np.add.accumulate(np.concatenate([[begin], gaps])), gaps",
        "np.add.accumulate(np.concatenate([[begin], gaps])).astype(np.float32).astype(np.float64), gaps",
        identity=True,
    ),
)

PULSES = (
    one(
        "triangle of the same peak",
        MOMENTS,
        "scenario/build.py",
        "pulse=PULSES[document.pulse.shape]",
        'pulse=PULSES["triangle"]',
    ),
    Mutant(
        "triangle of the same mean",
        (
            Edit("scenario/build.py", "pulse=PULSES[document.pulse.shape]", 'pulse=PULSES["triangle"]'),
            Edit("simulation/kernels_triangle.py", "_SLOPE = 0.25 * np.pi", "_SLOPE = 2.0 / 3.0"),
        ),
        MOMENTS,
    ),
    # The same life, peak and mean, and no slope at mid-life.
    one(
        "no kink",
        MOMENTS,
        "simulation/kernels.py",
        "# END generated\n",
        "# END generated\nAREA_COEFFICIENTS = (0.0, 2.06747893, -0.60066612, -0.68141465)\n",
    ),
    one(
        "second term of the lens 2 % off",
        MOMENTS,
        "simulation/kernels.py",
        _AREA,
        f"{_AREA} - 0.02 * {_SECOND_TERM}",
    ),
    one(
        "second term of a single life 2 % off",
        OVERLAP,
        "contact/overlap.py",
        "- x * np.sqrt((d - x) * (d + x))",
        "- 1.02 * x * np.sqrt((d - x) * (d + x))",
        identity=True,
    ),
    one(
        "second coefficient of the lens 2 % off",
        LENSES,
        "simulation/kernels.py",
        "-0.14142135623740776",
        "-0.14424978336495591",
        identity=True,
    ),
    one(
        "no kink where ticks are fine",
        FINE_LENSES,
        "simulation/kernels_fine.py",
        "add_kink(position, PANEL * kink + 1, born, inverse, in_spacings, weight, total, moments)",
        "pass",
        identity=True,
    ),
    one(
        "no kink in the slider's force",
        MOTION,
        "simulation/kernels.py",
        "        _pass_mid_life(positions, born, size, departure[row], scale, moments)\n",
        "",
        identity=True,
    ),
)

FORCES = (
    one(
        "force off by 1e6",
        LENSES,
        "simulation/area.py",
        "= model.strengths.mean * area",
        "= 1e6 * model.strengths.mean * area",
        identity=True,
    ),
    one(
        "strengths in Pa",
        STRENGTHS,
        "scenario/build.py",
        "strengths_for(strength.law, float(strength.mean)",
        "strengths_for(strength.law, 1e6 * float(strength.mean)",
        identity=True,
    ),
)


def _death_at(factor: str) -> tuple[Edit, ...]:
    """Return a life of another length wherever the batch engine knows of it."""
    return (
        Edit("record/rows.py", "return birth + 2.0 * diameter", f"return birth + {factor} * diameter"),
        Edit("simulation/state.py", "self.birth + 2.0 * self.diameter)", f"self.birth + {factor} * self.diameter)"),
    )


PLACES = (
    Mutant("death at d", _death_at("1.0"), MOMENTS),
    Mutant("death at 1.99 d", _death_at("1.99"), LIVES, identity=True),
    one("float32 positions", TICKS, "simulation/ticks.py", _TICK, f"np.float64(np.float32({_TICK}))", identity=True),
    one("off-by-one tick", TICKS, "simulation/ticks.py", _TICK, "float(first + n + 1) * spacing", identity=True),
    one(
        "count a tick late",
        LENSES,
        "simulation/ticks.py",
        "        live += change[tick]\n        count[tick] = live\n",
        "        count[tick] = live\n        live += change[tick]\n",
        identity=True,
    ),
)

MUTANTS = (*LAWS, *PULSES, *START_OF_A_RUN, *STREAM_USE, *PLACES, *FORCES)
