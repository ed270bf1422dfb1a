"""What holds for births at random alone says so here."""

from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.errors import Refused
from rubnoise.model import Model


def need_random_births(model: Model, quantity: str) -> None:
    """Raise Refused unless births are a Poisson process, as every formula made of filtered shot noise takes them."""
    if not isinstance(model.births, PoissonBirths):
        raise Refused(f"{quantity} is known for Poisson births alone (birth.law)")


def are_at_random(model: Model) -> bool:
    """Return whether births are a Poisson process (or else regular); raises Refused for a law without a theory."""
    if isinstance(model.births, PoissonBirths):
        return True
    if isinstance(model.births, RegularBirths):
        return False
    raise Refused("exact results are known for Poisson and for regular births alone (birth.law)")
