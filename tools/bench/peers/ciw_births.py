"""Ciw: births and deaths alone, as a queue with a server for each junction (M/G/infinity)."""

from math import inf

import ciw

from bench.case import Case, Drawn, Draws, Given, Output, doubles


def laws(case: Case, draws: Draws) -> tuple[ciw.dists.Distribution, ciw.dists.Distribution]:
    """Return gaps and lives in Ciw's own distributions, or in a given sequence."""
    if isinstance(draws, Given):
        gaps = [draws.gap() for _ in range(draws.birth.size + 1)]
        return ciw.dists.Sequential(gaps), ciw.dists.Sequential((2.0 * draws.sizes).tolist())
    life = ciw.dists.Normal(2.0 * case.mean_diameter, 2.0 * case.diameter_std)
    return ciw.dists.Exponential(1.0 / case.mean_gap), life


def births(case: Case, draws: Draws) -> Output:
    """Return births and deaths of all junctions that have died by the end."""
    if isinstance(draws, Drawn):
        ciw.seed(1)
    gaps, lives = laws(case, draws)
    network = ciw.create_network(arrival_distributions=[gaps], service_distributions=[lives], number_of_servers=[inf])
    simulation = ciw.Simulation(network)
    simulation.simulate_until_max_time(case.distance)
    records = sorted(simulation.get_all_records(), key=lambda record: record.arrival_date)
    return Output(
        birth=doubles([record.arrival_date for record in records]),
        death=doubles([record.exit_date for record in records]),
    )
