"""Faults of the page of lessons, which has the model once more in JavaScript, and of what is put into it."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "the page's area a power too low",
        "test_one_life_has_the_same_area",
        "return u > 0 ? diameter * diameter * u * Math.sqrt(u) * rising(u) : 0;",
        "return u > 0 ? diameter * u * Math.sqrt(u) * rising(u) : 0;",
    ),
    one(
        "the page's contact empty at the start",
        "test_a_start_is_stationary",
        "this.longest = 2 * this.contact.sizes.high;",
        "this.longest = 0;",
    ),
    one(
        "the page's gaps uniform",
        "test_gaps_are_exponential_and_sizes_normal",
        "return -Math.log(this.uniform());",
        "return 2 * this.uniform();",
    ),
    one(
        "the page's 0.327 a third",
        "test_numbers_are_those_of_the_package",
        "return Math.sqrt(wanted / 0.327);",
        "return Math.sqrt(3 * wanted);",
    ),
    one(
        "the page's moments of sizes miscounted",
        "test_numbers_are_those_of_the_package",
        "(n - 1) * this.std ** 2 * before",
        "n * this.std ** 2 * before",
    ),
    one(
        "the page's slider damped twice",
        "test_a_replayed_run_is_the_run",
        "const rate = damping / (2 * mass);",
        "const rate = damping / mass;",
    ),
    one(
        "the page's slider sticking at half the force",
        "test_on_the_same_field_the_landmarks_are_the_simulators",
        "if (Math.abs(pull) <= force) this.turn(STICK, 1);",
        "if (Math.abs(pull) <= 0.5 * force) this.turn(STICK, 1);",
    ),
    one(
        "the page's slider breaking away late",
        "test_statistics_are_the_simulators",
        "const duration = Math.max(0, force - pull) / (this.stiffness * this.drive);",
        "const duration = Math.max(0, 1.5 * force - pull) / (this.stiffness * this.drive);",
    ),
    one(
        "the page's force a broken line that is not moved",
        "test_on_the_same_field_the_landmarks_are_the_simulators",
        "this.force.push(Math.max(0, last.force + shift));",
        "this.force.push(Math.max(0, last.force + 0 * shift));",
    ),
    one(
        "the page's contact empty behind the start",
        "test_behind_the_start_the_contact_is_what_it_is_elsewhere",
        "this.rows.push({ birth: this.next, diameter, death, strength: this.world.strength });",
        "this.rows.push({ birth: this.next, diameter, death, strength: 0 });",
    ),
    one(
        "the page told doubles the wrong way round",
        "test_a_replayed_run_is_the_run",
        'np.ascontiguousarray(values, dtype="<f8")',
        'np.ascontiguousarray(values, dtype=">f8")',
    ),
    one(
        "the page's law of the area with each diameter as likely alive as born",
        "test_the_distribution_is_that_of_the_package",
        "sum += NODES.w[i] * half * diameter * sizes.density(diameter)",
        "sum += NODES.w[i] * half * sizes.mean * sizes.density(diameter)",
    ),
    one(
        "the page's bars of Poisson one place off",
        "test_the_bars_are_those_of_poisson",
        "found.push((found[n - 1] * mean) / n);",
        "found.push((found[n - 1] * mean) / (n + 1));",
    ),
    one(
        "the page's lanes of lives overlapping",
        "test_no_two_lives_of_a_lane_overlap_and_each_has_one",
        "(end) => end <= rows[i].birth",
        "(end) => 0.9 * end <= rows[i].birth",
    ),
    one(
        "the page's verdict at the click",
        "test_nothing_opens_before_its_time",
        "(step >= STEPS.run && (said === 'skipped' || look !== ''))",
        "step >= STEPS.run",
    ),
    one(
        "the page's numbers open before the prediction",
        "test_no_answer_is_in_the_text_before_its_prediction",
        "readout.shown || readout.level === 'all' || readout.level === column",
        "readout.shown || readout.level !== ''",
    ),
    one(
        "the page's passes off the centre line living as long as others",
        "test_passes_miss_the_centre_line_as_theory_says",
        "(offset ? Math.sqrt((diameter - offset) * (diameter + offset)) : diameter);",
        "(offset ? diameter : diameter);",
    ),
    one(
        "the page's spectrum off the centre line without its swing",
        "test_spectrum_and_autocovariance_are_those_of_the_package",
        "if (z < FAR) return near(z) * scale(z);",
        "return z < FAR ? near(z) * scale(z) : farLevel(z);",
    ),
    one(
        "the page's truth about a trace before anybody has read it",
        "test_each_trace_is_read_by_eye_first_and_the_truth_comes_last",
        "return law in known.read ? LEVELS.readings : LEVELS.trace;",
        "return LEVELS.truth;",
    ),
    one(
        "the page's lag of a half read one tick short",
        "test_the_lag_is_that_of_the_trace",
        "return after - 1 + (values[after - 1] - 0.5)",
        "return after - 2 + (values[after - 1] - 0.5)",
    ),
)
