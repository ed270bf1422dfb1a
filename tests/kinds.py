"""Contacts and sliders of every kind, as changes of one small scenario: for tests that ask something of each."""

from typing import Any

Kind = tuple[tuple[str, ...], dict[str, dict[str, Any]]]
"""Tables to leave out of the scenario of `tests.unit.tampering`, and what to change in others."""

BARE = ("strength", "slider")
SHORT = {"distance": "150 um"}
NO_SPEED = {"speed": None}

ONE_WAY: dict[str, Kind] = {
    "everything": ((), {}),
    "bare": (BARE, {"sliding": NO_SPEED}),
    "strength without speed": (("slider",), {"sliding": NO_SPEED}),
    "speed without strength": (BARE, {}),
    "gzip": ((), {"output": {"compression": "gzip"}}),
    "batch": ((), {"run": {"engine": "batch"}}),
    "empty start, slider at rest": ((), {"sliding": {"start": "empty"}, "slider": {"start": "rest"}}),
    "triangles": ((), {"pulse": {"shape": "triangle"}}),
    "parabolas of Rayleigh sizes": (
        (),
        {"pulse": {"shape": "parabola"}, "diameter": {"law": "weibull", "spread": "52.2723 %"}},
    ),
    "regular births": ((), {"birth": {"law": "regular"}}),
    "regular births of unequal sizes": (
        ("slider",),
        {"birth": {"law": "regular"}, "diameter": {"law": "lognormal", "spread": "60 %"}},
    ),
    "Rabinowicz's": (
        (),
        {"birth": {"law": "regular"}, "pulse": {"shape": "triangle"}, "diameter": {"law": "fixed", "spread": None}},
    ),
    "lognormal sizes and strengths": (
        (),
        {"diameter": {"law": "lognormal", "spread": "70 %"}, "strength": {"law": "lognormal", "spread": "60 %"}},
    ),
    "exponential sizes, Weibull strengths": (
        (),
        {"diameter": {"law": "exponential", "spread": None}, "strength": {"law": "weibull", "spread": "60 %"}},
    ),
    "gamma sizes, normal strengths": (
        (),
        {"diameter": {"law": "gamma", "spread": "40 %"}, "strength": {"law": "normal", "spread": "80 MPa"}},
    ),
    "overdamped": ((), {"slider": {"damping": "50 N*s/m"}, "sliding": SHORT}),
    "slow": ((), {"sliding": {"speed": "10 um/s", "distance": "60 um"}}),
    "slow triangles": ((), {"sliding": {"speed": "10 um/s", "distance": "60 um"}, "pulse": {"shape": "triangle"}}),
    "slow parabolas": ((), {"sliding": {"speed": "10 um/s", "distance": "60 um"}, "pulse": {"shape": "parabola"}}),
    "coarse ticks": ((), {"output": {"tick": "10 um"}}),
    "more ticks than a panel": ((), {"output": {"tick": "0.002 um"}, "sliding": SHORT}),
    "more rows than a panel": (
        ("slider",),
        {
            "interface": {"mean_junction_count": 2000},
            "diameter": {"spread": "10 %"},
            "sliding": {"distance": "50 um"},
            "run": {"engine": "batch"},
        },
    ),
    "off the centre line": ((), {"pulse": {"offset": "uniform"}}),
    "thin": ((), {"interface": {"mean_junction_count": 0.02}}),
    "nobody at all": ((), {"interface": {"mean_junction_count": 0.0001}, "sliding": SHORT}),
}
_TWO_WAY: dict[str, dict[str, dict[str, Any]]] = {
    "figure 5": {},
    "slow, a slip in a row": {"sliding": {"speed": "10 um/s", "distance": "60 um"}, "output": {"tick": "0.3 um"}},
    "few and slow, slips of many lives in a row": {
        "interface": {"mean_junction_count": 5},
        "sliding": {"speed": "0.1 mm/s", "distance": "3000 um"},
        "output": {"tick": "1 um"},
        "run": {"engine": "batch", "seed": 103},
    },
    "faster": {"sliding": {"speed": "10 mm/s"}},
    "fast": {"sliding": {"speed": "1 m/s"}},
    "few": {"interface": {"mean_junction_count": 0.5}, "sliding": {"distance": "6000 um"}, "output": {"tick": "2 um"}},
    "many": {"interface": {"mean_junction_count": 300}, "sliding": {"distance": "5 um"}, "output": {"tick": "0.05 um"}},
    "coarse": {"output": {"tick": "7 um"}},
    "fine": {"output": {"tick": "0.005 um"}, "sliding": {"distance": "30 um"}},
    "triangles": {"pulse": {"shape": "triangle"}},
    "parabolas": {"pulse": {"shape": "parabola"}},
    "unequal": {"diameter": {"law": "exponential", "spread": None}, "strength": {"law": "normal", "spread": "80 MPa"}},
    "regular": {"birth": {"law": "regular"}},
    "empty start, slider at rest": {"sliding": {"start": "empty"}, "slider": {"start": "rest"}},
    "tight": {"slider": {"tolerance": 1e-12}},
    "loose": {"slider": {"tolerance": 1e-4}},
    "soft": {"slider": {"stiffness": "3 N/m"}, "sliding": {"distance": "40 um"}},
    "damped": {"slider": {"damping": "50 N*s/m"}},
    "gzip": {"output": {"compression": "gzip"}, "run": {"engine": "batch"}},
    "nobody at all": {"interface": {"mean_junction_count": 0.0001}, "sliding": {"distance": "150 um"}},
}

COUPLED: dict[str, Any] = {"coupling": "two-way"}

TWO_WAY: dict[str, Kind] = {
    name: ((), changes | {"slider": COUPLED | changes.get("slider", {})}) for name, changes in _TWO_WAY.items()
}
