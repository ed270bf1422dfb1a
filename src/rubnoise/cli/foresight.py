"""How an answer tells what a run will take."""

from rubnoise.storage.budget import Budget


def told(budget: Budget) -> dict[str, float]:
    """Return a budget by the names that answers have for it; estimates to three digits."""
    return {
        "junctions": budget.junctions,
        "ticks": budget.ticks,
        "bytes": budget.result_bytes,
        "peak_memory": int(float(f"{budget.peak_bytes:.3g}")),
        "seconds": float(f"{budget.seconds:.3g}"),
    }
