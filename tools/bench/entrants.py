"""The tools of the benchmark, their parts, and how long each runs: slow ones run shorter."""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from bench.case import Case, Draws, Output

OURS = "rubnoise, "
NAIVE_SIMPY = "naive SimPy, RK4"
NAIVE_NUMPY = "naive NumPy, lsim"
SUPERPOSED = "superposed-pulses, lsim"
SUPERPOSED_AREA = "superposed-pulses"
NUMBA = "numba loops, RK4"
CIW = "Ciw"
SALABIM = "salabim"


@dataclass(frozen=True)
class Entrant:
    """One way to do it: its name, where it stands, and how many junctions it is given in one repeat, full and quick.

    ``function`` of bench.``module`` takes a case, draws, a path where it makes a whole run, and our engine if ours.
    """

    name: str
    module: str
    function: str
    junctions: int
    quick_junctions: int
    engine: str = ""

    def call(self, case: Case, draws: Draws, *path: Path) -> Output | None:
        """Make a run, into a file where there is a path; its library is loaded here and not before."""
        function = getattr(import_module(f"bench.{self.module}"), self.function)
        return function(case, draws, *path, **({"engine": self.engine} if self.engine else {}))


FASTEST = "batch"
"""Our fastest engine."""


def _ours(function: str, engines: tuple[str, ...] = ("batch", "events"), of: str = "") -> tuple[Entrant, ...]:
    return tuple(Entrant(f"{OURS}{name}{of}", "ours", function, 100_000, 100_000, name) for name in engines)


RUNS = (
    *_ours("run"),
    Entrant(NUMBA, "peers.numba_loops", "run", 100_000, 20_000),
    Entrant(SUPERPOSED, "peers.superposed", "run", 10_000, 2_000),
    Entrant(NAIVE_NUMPY, "peers.naive_numpy", "run", 10_000, 2_000),
    Entrant(NAIVE_SIMPY, "peers.naive_simpy", "run", 5_000, 1_000),
)
"""Tools that make a whole run: births, area, force, slider, and a file of it all."""

AREAS = (
    *_ours("area_alone"),
    Entrant("numba loops", "peers.numba_loops", "area_alone", 100_000, 20_000),
    Entrant(SUPERPOSED_AREA, "peers.superposed", "area_alone", 20_000, 5_000),
    Entrant("naive NumPy", "peers.naive_numpy", "area_alone", 20_000, 5_000),
)
"""Tools that make births and the trace of the area, in memory."""

IN_MEMORY = (
    *_ours("area_alone", (FASTEST,), ", area"),
    Entrant("numba loops, area", "peers.numba_loops", "area_alone", 100_000, 20_000),
    *_ours("area_and_slider", (FASTEST,), ", area and slider"),
    Entrant("numba loops, area and slider", "peers.numba_loops", "area_and_slider", 100_000, 20_000),
)
"""Our fastest engine and the loops that come closest, in memory: the area alone, and with the slider."""

BIRTHS = (
    Entrant(CIW, "peers.ciw_births", "births", 20_000, 5_000),
    Entrant(SALABIM, "peers.salabim_births", "births", 2_000, 500),
)
"""Tools that only tell births and deaths: discrete-event libraries that know no area."""
