"""How an answer tells what a run will take."""

from rubnoise.storage.forecast import Budget


def told(budget: Budget) -> dict[str, float]:
    """Return a budget by the names that answers have for it; estimates to three digits."""
    grown = budget.slider_rows_at_most
    return {
        "junctions": budget.junctions,
        "ticks": budget.ticks,
        **({} if grown is None else {"slider_rows_at_most": grown}),
        "bytes": budget.result_bytes,
        "free_disk": budget.disk_bytes,
        "peak_memory": int(float(f"{budget.peak_bytes:.3g}")),
        "seconds": float(f"{budget.seconds:.3g}"),
    }
