"""salabim: births and deaths alone, a component a junction, in generators, which need no second thread."""

from typing import Any

import salabim

from bench.case import Case, Draws, Output, doubles


class Junction(salabim.Component):  # type: ignore[misc]
    """Lives for twice its diameter, and is noted."""

    def setup(self, diameter: float, noted: list[tuple[float, float]]) -> None:
        """Take what the births hand over."""
        self.diameter, self.noted = diameter, noted

    def process(self) -> Any:
        """Live."""
        birth = self.env.now()
        yield self.hold(2.0 * self.diameter)
        self.noted.append((birth, self.env.now()))


class Births(salabim.Component):  # type: ignore[misc]
    """Waits for a gap, starts a junction, and so on."""

    def setup(self, draws: Draws, noted: list[tuple[float, float]]) -> None:
        """Take where junctions come from and go to."""
        self.draws, self.noted = draws, noted

    def process(self) -> Any:
        """Go on until the end of the run."""
        while True:
            yield self.hold(self.draws.gap())
            Junction(diameter=self.draws.diameter(), noted=self.noted)


def births(case: Case, draws: Draws) -> Output:
    """Return births and deaths of all junctions that have died by the end."""
    noted: list[tuple[float, float]] = []
    env = salabim.Environment(trace=False, yieldless=False)
    Births(draws=draws, noted=noted)
    env.run(till=case.distance)
    noted.sort()
    return Output(birth=doubles([birth for birth, _ in noted]), death=doubles([death for _, death in noted]))
