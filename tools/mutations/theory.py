"""Faults of the exact theory, with which runs are compared."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "cumulants with a moment too low",
        "test_cumulants_are_those_of_the_characteristic_function",
        "model.sizes.moment(2 * order + 1)",
        "model.sizes.moment(2 * order)",
    ),
    one(
        "unequal strengths taken for equal ones",
        "test_unequal_strengths_bring_their_own_moments",
        "strength_moments[n] *",
        "strength_moments[1] ** n *",
    ),
    one(
        "one-sided density half as high",
        "test_both_densities_integrate_to_the_variance",
        "return spectral_density(model, wavenumber) / pi",
        "return spectral_density(model, wavenumber) / (2.0 * pi)",
    ),
    one(
        "half power taken for half amplitude",
        "test_corner_of_one_size",
        "half = 0.5 * float(spectral_density(model, 0.0))",
        "half = 0.25 * float(spectral_density(model, 0.0))",
    ),
    one(
        "damping of the response doubled",
        "test_both_stds_against_the_time_domain",
        "np.square(slider.damping * frequency)",
        "np.square(2.0 * slider.damping * frequency)",
    ),
    one(
        "variance of a tick counted twice",
        "test_error_of_the_mean_is_exact_for_any_record_and_tick",
        "weights[0] = 1.0 / ticks",
        "weights[0] = 2.0 / ticks",
    ),
    one(
        "skewness as if the mean were known",
        "test_errors_of_all_four_moments",
        "[-3.0, -1.5 * g, 1.0, 0.0]",
        "[0.0, -1.5 * g, 1.0, 0.0]",
    ),
    one(
        "atom at zero of twice the junctions",
        "test_mass_and_four_cumulants_by_the_density",
        "atom_at_zero=exp(-count)",
        "atom_at_zero=exp(-2.0 * count)",
    ),
    one(
        "live areas not length-biased",
        "test_moments_are_the_life_integrals_of_what_is_alive",
        "weights * sizes.density(diameters) / diameters * unit(",
        "weights * sizes.density(diameters) / diameters**2 * unit(",
    ),
    one(
        "counts forgotten after d",
        "test_covariance_is_the_life_that_is_left",
        "diameters * model.pulse.lives_left(reach / diameters), axis=-1)",
        "diameters * (model.pulse.lives_left(reach / diameters + 1.0)), axis=-1)",
    ),
    one(
        "growth from empty that ends at mid-life",
        "test_area_grows_from_empty_as_the_lives_do",
        "np.where(age < 1.0, rising, pulse.life_integral(1) - rising)",
        "np.where(age < 1.0, rising, 0.5 * pulse.life_integral(1))",
    ),
    one(
        "a sign in the Struve function's tail",
        "test_transform_of_a_life_over_fourteen_decades",
        "total = 1.0 + ratio * inverse * total",
        "total = 1.0 - ratio * inverse * total",
    ),
    one(
        "cumulants of a mixture miscounted",
        "test_cumulants_of_one_size_are_those_of_a_periodic_function",
        "sum(comb(n - 1, i) * found[i] * moments[n - 1 - i] for i in range(n - 1))",
        "sum(comb(n, i) * found[i] * moments[n - 1 - i] for i in range(n - 1))",
    ),
    one(
        "coupling that falls too slowly with speed",
        "test_the_strength_is_that_of_the_sixth_moment",
        "drive.slider.damping * drive.speed**3)",
        "drive.slider.damping * drive.speed**2)",
    ),
    one(
        "damping that acting back does not undo",
        "test_the_printed_figures_of_weak_coupling",
        "(3.0 + 10.0 * kick) * strength",
        "(1.0 + 10.0 * kick) * strength",
    ),
    one(
        "kick of a junction left out",
        "test_the_law_is_that_of_oscillators_hit_by_junctions_without_width",
        "sqrt(2.0 * (1.0 + kick) / (lost + sqrt(under_root)))",
        "sqrt(2.0 / (lost + sqrt(under_root)))",
    ),
    one(
        "slope of the lens taken for that of its square",
        "test_squared_slope_is_the_integral_of_the_slope_squared",
        "return 4.0 / 3.0",
        "return 2.0 / 3.0",
    ),
    one(
        "slopes of neighbours that do not meet",
        "test_the_variance_of_the_slope_is_the_curvature_of_the_autocovariance[regular]",
        "np.square(total) - squares",
        "-squares",
    ),
    one(
        "mean of a weakly coupled slider without what the dashpot takes",
        "test_the_weak_motion_is_the_one_way_motion_with_more_energy",
        "one_way.mean_displacement + excess / drive.slider.stiffness",
        "one_way.mean_displacement",
    ),
    one(
        "swing off the centre line of the wrong weight",
        "test_the_energy_spectrum_is_its_integral_over_the_plane",
        "((1, 0.5), (2, 0.125))",
        "((1, 0.5), (2, 0.25))",
    ),
    one(
        "offsets of one side alone in the autocovariance",
        "test_spectrum_and_autocovariance_are_transforms_of_each_other",
        "* q / (4.0 * np.pi)",
        "* q / (8.0 * np.pi)",
    ),
    one(
        "live areas off the centre line as of one line",
        "test_contacts_drawn_by_births_and_offsets_have_the_distribution",
        "2.0 * (1.0 - u) / np.sqrt(u * (2.0 - u))",
        "1.0 / np.sqrt(u * (2.0 - u))",
    ),
    one(
        "S(0) from the mean life and not from its square",
        "test_power_at_zero_is_more_by_58_per_cent",
        "model.pulse.squared_integral * model.sizes.moment(6)",
        "model.pulse.life_integral(1) ** 2 * model.sizes.moment(6)",
    ),
)
