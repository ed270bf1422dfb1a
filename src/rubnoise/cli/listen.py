"""`rubnoise listen`: a run as sound."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class What(StrEnum):
    """What can be heard."""

    VELOCITY = "velocity"
    FORCE = "force"
    DISPLACEMENT = "displacement"


class Rate(StrEnum):
    """Samples a second."""

    CD = "44100"
    VIDEO = "48000"


def command(
    file: Annotated[Path, typer.Argument(help="A result file.", metavar="RUN.h5", show_default=False)],
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="The file to write; default: RUN_WHAT.wav, in this folder.", metavar="WAV"),
    ] = None,
    what: Annotated[
        What, typer.Option(help="The sound: velocity, force or displacement.", metavar="WHAT")
    ] = What.VELOCITY,
    speed_up: Annotated[
        float, typer.Option("--speed-up", help="Factor by which the sound is faster than the run.", metavar="X")
    ] = 1.0,
    seconds: Annotated[
        float | None,
        typer.Option(help="Length of the sound, from the start; default: all.", metavar="S", show_default=False),
    ] = None,
    rate: Annotated[Rate, typer.Option(help="Samples a second: 44100 or 48000.", metavar="RATE")] = Rate.VIDEO,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Write the slider's motion as sound: band-limited, without mean, peak at -3 dB, physical scale in the file.

    Example: rubnoise listen fig5.h5 -o noise.wav --speed-up 10
    """
    from math import isfinite

    from rubnoise.analysis.sound import Sound, level_of, samples_of
    from rubnoise.cli.listen_text import comments, told
    from rubnoise.cli.progress import watching
    from rubnoise.cli.results import finished_run
    from rubnoise.storage.output import check_output, whole_file
    from rubnoise.storage.wave_file import check_length, write_wave

    for option, value in (("--speed-up", speed_up), ("--seconds", seconds)):
        if value is not None and not (isfinite(value) and value > 0.0):
            raise typer.BadParameter(f"{option}: {value:g} is no number above 0")
    path = output or Path(f"{file.stem}_{what}.wav")
    if path.suffix.lower() != ".wav":
        raise typer.BadParameter(f"{path} does not end in .wav")
    check_output(path, force=force)
    with finished_run(file) as run, watching(1.0, shown=False) as watcher:
        sound = Sound.of(run, what.value, rate=int(rate), speed_up=speed_up, seconds=seconds)
        check_length(sound.samples)
        level = level_of(sound, lambda: watcher(0.0, 0, 0))
        with whole_file(path, force=force) as part:
            panels = samples_of(sound, level, lambda: watcher(0.0, 0, 0))
            write_wave(part, panels, samples=sound.samples, rate=sound.rate, texts=comments(sound, level))
        print(*told(path, sound, level), sep="\n")
