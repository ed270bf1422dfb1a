"""Published peaks of vibration, and whether roughness moves them."""

from rubnoise.analysis.replicates import ratio
from rubnoise.claims import sources
from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.evidence import Evidence, Found
from rubnoise.claims.field import FieldClaim
from rubnoise.theory.response import response

FAST = "claims/field_fast.toml"
SLOW = "claims/field_slow.toml"
NORMAL = "Normal motion; the model moves along the surface"


def frequencies(fast: Evidence) -> list[FieldClaim]:
    """Return the rows on natural and dominating frequencies, from runs at 20 mm/s with 5 and 20 junctions."""
    fine, rough = fast.at(count=20, speed=20_000.0), fast.at(count=5, speed=20_000.0)
    pairs = [(point.numbers["frequency"], _frequency(point)) for point in (fine, rough)]
    moved = ClaimedNumber(
        name="mean frequency of motion, 5 junctions over 20",
        simulated=ratio(pairs[1][0], pairs[0][0]),
        exact=pairs[1][1] / pairs[0][1],
    )
    return [
        FieldClaim(
            id="stoimenov2007",
            label="shift of the peak by roughness",
            source=sources.STOIMENOV_2007,
            statement="The first peak moves from 3.0 to 4.5 kHz with roughness; up or down was not seen.",
            conditions="stainless-steel plates of Rz 0.8 to 12.4 um, rubbed by hand, flat on flat",
            quantity=moved,
            published=(1.5, 1.5),
            because="The model's peak stays; a factor of 1/1.5 is as far from it. A peak that moves needs a contact "
            "stiffness that depends on roughness.",
            scenario=FAST,
        ),
    ]


def _frequency(point: Found) -> float:
    """Return std x' over std x in rad/s, which is 2 pi times the mean rate of a Gaussian motion."""
    motion = response(point.model)
    return motion.velocity_std / motion.displacement_std
