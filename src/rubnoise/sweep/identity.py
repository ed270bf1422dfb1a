"""Whether a folder is of this sweep: what is kept of a sweep to tell, and how two of them differ."""

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, Final

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import build
from rubnoise.scenario.points import Case, run_id
from rubnoise.scenario.scenario import flattened
from rubnoise.scenario.sweep import Sweep
from rubnoise.scenario.sweep_problems import in_words
from rubnoise.streams import STREAM_VERSION

FORMAT: Final = "rubnoise-sweep"
FORMAT_VERSION: Final = 1

_FREE: Final = ("title", "run.engine")
"""What may change: it has no part in the names of runs."""


def identity(sweep: Sweep) -> dict[str, Any]:
    """Return what tells a sweep from others (JSON-able): its points by name, and the whole scenario of the first."""
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": sweep.title,
        "keys": list(sweep.keys),
        "keep": sweep.keep,
        "stream_version": STREAM_VERSION,
        "points": [{"values": dict(case.values), "name": run_id(case.scenario)} for case in sweep.cases],
        "first": sweep.cases[0].scenario.resolved(),
    }


def manifest_text(told: Mapping[str, Any]) -> str:
    """Return the text of sweep.json."""
    return f"{json.dumps(told)}\n"


def cases_of(kept: Mapping[str, Any]) -> tuple[Case | None, ...]:
    """Return the points of a sweep from what is kept to tell it, each by its name; None for one that has another name.

    A tick that the file did not give follows from the other keys at each point, so the first one's is not for all.
    """
    return tuple(_case(kept["first"], point["values"], point["name"]) for point in kept["points"])


def _case(first: Mapping[str, Any], values: Mapping[str, Any], name: str) -> Case | None:
    told = {section: dict(table) if isinstance(table, Mapping) else table for section, table in first.items()}
    for key, value in values.items():
        section, _, inner = key.partition(".")
        told.setdefault(section, {})[inner] = value
    without_tick = {**told, "output": {key: value for key, value in told["output"].items() if key != "tick"}}
    for each in (told, without_tick):
        with suppress(ScenarioRefused):
            scenario = build(each)
            if run_id(scenario) == name:
                return Case(values=values, scenario=scenario)
    return None


def difference(kept: Mapping[str, Any], sweep: Sweep) -> str | None:
    """Return in what a sweep differs from the one kept, or None where it goes on with it.

    It may have more points and other replicates: seeds do not depend on either.
    """
    if kept["stream_version"] != STREAM_VERSION:
        return f"its random streams are of version {kept['stream_version']}, and those of today of {STREAM_VERSION}"
    if kept["keep"] != sweep.keep:
        return f'sweep.keep is "{kept["keep"]}" there, and "{sweep.keep}" here'
    there = {run_id(case.scenario) for case in sweep.cases}
    gone = [point for point in kept["points"] if point["name"] not in there]
    if not gone:
        return None
    changed = next(_changes(kept, sweep), None)
    if changed is not None:
        return changed
    more = f", and {len(gone) - 1:,} more" if len(gone) > 1 else ""
    return f"it has a point that this one lacks: {in_words(gone[0]['values']) or 'no key swept'}{more}"


def _changes(kept: Mapping[str, Any], sweep: Sweep) -> Iterator[str]:
    """Yield the keys outside of the swept ones in which the scenarios differ."""
    values = kept["points"][0]["values"]
    same = next((case for case in sweep.cases if dict(case.values) == values), sweep.cases[0])
    before, now = flattened(kept["first"]), flattened(json.loads(json.dumps(same.scenario.resolved())))
    swept = {*kept["keys"], *sweep.keys, *_FREE}
    # The tick comes last, since without one in the file it follows from the others.
    for key in sorted(before.keys() | now.keys(), key=lambda key: (key == "output.tick", key)):
        if key not in swept and before.get(key) != now.get(key):
            yield f"{key} is {_shown(before.get(key))} there, and {_shown(now.get(key))} here"


def _shown(value: Any) -> str:
    return "not given" if value is None else str(value)
