"""Faults of the run itself: what is drawn and when, what is summed at the ticks, how the slider is moved."""

from __future__ import annotations

from mutations.contact import MOMENTS
from mutations.mutant import Edit, Mutant, one

START = "test_who_is_alive_at_the_start"
STREAMS = "test_streams_and_blocks_are_independent"
BIRTHS = "test_births_are_those_that_the_streams_hold[events]"
LIVES = "test_every_life_lasts_two_diameters[batch]"
TICKS = "test_ticks_lie_at_multiples_of_the_tick[batch]"
SUMS = "test_area_count_and_force_follow_from_the_rows"
LENSES = f"{SUMS}[lenses-batch]"
MOTION = "test_the_motion_follows_from_the_rows[0.1 um-batch]"

_TICK = "float(first + n) * spacing"
_AREA = "fused(alive * (u * root(u)), polynomial(AREA_COEFFICIENTS, u), load(total, at))"

START_OF_A_RUN = (
    one(
        "empty start",
        START,
        'live = _stationary_rows(model, seed) if model.start == "stationary" else LiveRows.none()',
        "live = LiveRows.none()",
        chance=True,
    ),
    one(
        "start sizes not length-biased",
        START,
        "keep = generator.random(values.size) * largest < values",
        "keep = generator.random(values.size) < 2.0",
        chance=True,
    ),
    one(
        "start count fixed",
        START,
        "count = _poisson(seed, 2.0 * model.birth_rate * model.sizes.moment(1))",
        "count = round(2.0 * model.birth_rate * model.sizes.moment(1))",
        chance=True,
    ),
    one(
        "start ages of half a life",
        START,
        "birth = -(2.0 * diameter) * uniforms(",
        "birth = -diameter * uniforms(",
        chance=True,
    ),
    one(
        "regular lives end at d before the start",
        "test_so_many_are_alive_at_every_tick",
        "alive = birth + 2.0 * diameter > 0.0",
        "alive = birth + diameter > 0.0",
    ),
)

STREAM_USE = (
    one(
        "births and sizes on one stream",
        STREAMS,
        "key = np.array([seed, int(stream)], dtype=np.uint64)",
        "key = np.array([seed, 2 if stream == 3 else int(stream)], dtype=np.uint64)",
        chance=True,
    ),
    Mutant(
        "a block's stream reused",
        (
            Edit("np.array([0, 0, block, 0], dtype", "np.array([0, 0, block // 2, 0], dtype"),
            Edit('["counter"][2] = number', '["counter"][2] = number // 2'),
        ),
        STREAMS,
        chance=True,
    ),
    Mutant(
        "first birth of a block dropped",
        (
            Edit("birth=birth[:count],", "birth=birth[1:count],"),
            Edit("gaps=gaps[:count],", "gaps=gaps[1:count],"),
            Edit("Stream.DIAMETERS, block, blocks)[:count],", "Stream.DIAMETERS, block, blocks)[1:count],"),
            Edit("Stream.STRENGTHS, block, blocks)[:count],", "Stream.STRENGTHS, block, blocks)[1:count],"),
        ),
        BIRTHS,
    ),
    one(
        "float32 births",
        BIRTHS,
        "np.add.accumulate(np.concatenate([[begin], gaps])), gaps",
        "np.add.accumulate(np.concatenate([[begin], gaps])).astype(np.float32).astype(np.float64), gaps",
    ),
)

KERNELS = (
    # The same life, peak and mean, and no slope at mid-life.
    one(
        "no kink",
        MOMENTS,
        "AREA_COEFFICIENTS = (\n0.9428090415820636, -0.14142135623740776,",
        "AREA_COEFFICIENTS = (0.0, 2.06747893, -0.60066612, -0.68141465)\n_ = (0.9428090415820636, -0.1414,",
        chance=True,
    ),
    one(
        "second term of the lens 2 % off",
        MOMENTS,
        _AREA,
        f"{_AREA} - spread(0.02) * alive * (spread(1.0) - u) * root(u * (two - u)) * spread(0.5)",
        chance=True,
    ),
    one("second coefficient of the lens 2 % off", LENSES, "-0.14142135623740776", "-0.14424978336495591"),
    one(
        "no kink where ticks are fine",
        f"{SUMS}[lenses, fine ticks-batch]",
        "add_kink(position, PANEL * kink + 1, born, inverse, in_spacings, weight, total, moments)",
        "pass",
    ),
    one(
        "no kink in the slider's force",
        MOTION,
        "_pass_mid_life(position, edge, end, middle, base, born, width, inverse, left, scale, gathered)",
        "pass",
    ),
    one(
        "bend of a triangle's kink a third off",
        "test_kernels_polynomial.py::test_moments_of_cells_that_hold_births_mid_lives_and_deaths",
        "moments[2, cell] += beside * r * (1.0 - r) / 2.0",
        "moments[2, cell] += beside * r * (1.0 - r) / 3.0",
    ),
    one("force off by 1e6", LENSES, "= model.strengths.mean * area", "= 1e6 * model.strengths.mean * area"),
)


def _death_at(factor: str) -> tuple[Edit, ...]:
    """Return a life of another length wherever the batch engine knows of it."""
    return (Edit("return self.birth + 2.0 * self.half_life", f"return self.birth + {factor} * self.half_life"),)


PLACES = (
    Mutant("death at d", _death_at("1.0"), MOMENTS, chance=True),
    Mutant("death at 1.99 d", _death_at("1.99"), LIVES),
    one("float32 positions", TICKS, _TICK, f"np.float64(np.float32({_TICK}))"),
    one("off-by-one tick", TICKS, _TICK, "float(first + n + 1) * spacing"),
    one(
        "count a tick late",
        LENSES,
        "live += change[tick] count[tick] = live",
        "count[tick] = live\nlive += change[tick]",
    ),
    one(
        "lives forgotten between blocks",
        "test_small_blocks_are_played_together_and_each_ones_start_is_written",
        "beyond = np.flatnonzero(np.minimum(rows.departure, natural) > last_tick)",
        "beyond = np.flatnonzero(np.minimum(rows.departure, natural) > last_tick + 5.0)",
    ),
    one(
        "a tick at a birth given to the block before",
        "test_ticks_and_births_are_told_apart_to_the_last_bit",
        "while float(tick) * model.tick < distance:",
        "while float(tick) * model.tick <= distance:",
    ),
    one(
        "an interrupt that ends nothing",
        "test_rows_show_when_and_how_they_ended",
        "except Interrupt: death = ended(env, live, row, death) del live.processes[live.numbers[row]]",
        "except Interrupt:\n    pass\ndel live.processes[live.numbers[row]]",
    ),
    one(
        "an intervention that ends with its block",
        "test_an_intervention_knows_nothing_of_blocks",
        "if not isinstance(entry[3], Wait)]",
        "if False]",
    ),
    one(
        "mid-life told at half of it",
        "test_everything_is_told_once_and_in_order",
        "middle = rows.birth + rows.half_life",
        "middle = rows.birth + 0.5 * rows.half_life",
    ),
)

SLIDER = (
    one(
        "gain of the second moment too small",
        "test_constants_of_every_damping",
        "weight = (2 * i + 1) / (mpmath.mpf(slider.mass)",
        "weight = (i + 1) / (mpmath.mpf(slider.mass)",
    ),
    one(
        "velocity from the place after the step",
        MOTION,
        "fused(v_from_x, x, push_v)",
        "fused(v_from_x, next_x, push_v)",
    ),
    one(
        "steps of the slider too coarse",
        "test_the_promise_holds_for_every_speed_and_damping",
        "TARGET = 3e-10",
        "TARGET = 3e-5",
    ),
)

FROZEN = "test_a_constant_force[0.02-1000.0--9000.0-20]"
_PULL = "way * (stiffness * x + damping * drive)"

TWO_WAY = (
    Mutant(
        "friction of the same sign in reversal",
        (
            Edit(
                f"net, pull = {_PULL} - mean,",
                f"mean, slope, bend = way * mean, way * slope, way * bend\nnet, pull = {_PULL} - mean,",
            ),
            Edit(
                "- spread(stiffness) * passed - force store",
                "- spread(stiffness) * passed - spread(way) * force\nstore",
            ),
            Edit(
                "- spread(damping) * speed) - force) * per_mass",
                "- spread(damping) * speed) - toward * force) * per_mass",
            ),
            Edit(
                "growth = (pull - force_in_cell(offset, part))", "growth = (pull - way * force_in_cell(offset, part))"
            ),
            Edit("- damping * after - force) / mass", "- damping * after - way * force) / mass"),
        ),
        FROZEN,
    ),
    # Neither test for w = 0 is suspended: rounding decides the sign of w' and so whether the slider sticks again.
    Mutant(
        "stuck again at a breakaway",
        (
            Edit("if whole[FRESH] == 0:", "if True:"),
            Edit(
                "abs(numbers[RELATIVE]), constants[SPACING], constants[DRIVE]",
                "max(abs(numbers[RELATIVE]), 1e-300), constants[SPACING], constants[DRIVE]",
            ),
        ),
        "test_after_a_breakaway_the_slider_moves_on",
    ),
    Mutant(
        "static force used in slip",
        (
            Edit(
                "force_in_lanes(fused(spread(way), passed, spread(offset)), part)",
                "force_in_lanes(spread(offset), part)",
            ),
            Edit("force_in_lanes(fused(toward, passed, place), part)", "force_in_lanes(place, part)"),
        ),
        "test_cases_at_random[0]",
    ),
    one(
        "grazing not looked for",
        "test_on_a_steady_rise_without_damping_every_period_ends_in_a_stick_of_no_length[0.0]",
        "if slope_before < 0.0 and slope >= 0.0:",
        "if False:",
    ),
    one(
        "births repeated on retracing",
        "test_births_that_are_passed_again_are_told_once_and_when_they_were_passed_first",
        "whole[layout.BORN] = len(living) - np.count_nonzero(np.isnan(births))",
        "whole[layout.BORN] = np.searchsorted(living.birth, state.distance(constants))",
    ),
    one(
        "drive 1 % too fast",
        "test_another_speed_of_the_drive_is_seen",
        "found[:4] = slider.mass, slider.stiffness, slider.damping, speed",
        "found[:4] = slider.mass, slider.stiffness, slider.damping, 1.01 * speed",
    ),
)

OFF_CENTRE_LIFE = "test_areas_and_moments_are_those_of_many_digits[110.0-60.0-2.0]"
OFF_CENTRE = (
    one(
        "lives off the centre line 1 % too long",
        "test_rows_are_what_the_offset_says",
        "np.sqrt((diameter - offset) * (diameter + offset))",
        "1.01 * np.sqrt((diameter - offset) * (diameter + offset))",
    ),
    one(
        "offsets of one side alone",
        "test_a_run_is_accepted_by_its_theory[contact]",
        "return (2.0 * uniform - 1.0) + 2.0**-53",
        "return np.abs(2.0 * uniform - 1.0) + 2.0**-53",
    ),
    one(
        "offsets at the start as at birth",
        "test_the_start_has_more_of_long_lives",
        "found.append(x[x * x + y * y < 1.0])",
        "found.append(x)",
    ),
    one(
        "areas at ticks as of passes through both centres",
        OFF_CENTRE_LIFE,
        "u = larger(one - root(fused(x, x, aside)), nothing)",
        "u = larger(one - root(x * x), nothing)",
    ),
    one(
        "falling halves not seen in a mirror",
        OFF_CENTRE_LIFE,
        "mirror = where_above(nothing, x, spread(-1.0), one)",
        "mirror = one",
    ),
    one(
        "the turn taken for smooth",
        "test_areas_and_moments_are_those_of_many_digits[110.0-0.01-2.0]",
        "NEAR = 3.5",
        "NEAR = 0.0",
    ),
    one(
        "greatest areas as of passes through both centres",
        "test_the_largest_area_is_that_at_mid_life",
        "u = 1.0 - abs(offset[row]) / diameter[row]",
        "u = 1.0",
    ),
    one(
        "offsets left out of a state",
        "test_offsets_survive_too_and_a_state_from_before_them_has_none",
        'numbers.pop("offsets", False)',
        'numbers.pop("offsets", False) and False',
    ),
)

MUTANTS = (*START_OF_A_RUN, *STREAM_USE, *KERNELS, *PLACES, *SLIDER, *TWO_WAY, *OFF_CENTRE)
