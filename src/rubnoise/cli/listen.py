"""`rubnoise listen`: a run as sound, and the audible part of it."""

from collections.abc import Iterator
from contextlib import ExitStack
from enum import StrEnum
from functools import partial
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from rubnoise import __version__
from rubnoise.answer import Answer, Row
from rubnoise.cli.layout import grouped, show
from rubnoise.cli.options import ReplaceFile
from rubnoise.cli.signals import stoppable

if TYPE_CHECKING:
    from collections.abc import Callable

    from rubnoise.analysis.hearing import Hearing
    from rubnoise.analysis.sound import Heard, Level, Sound

What = StrEnum("What", "velocity force displacement normal-velocity load")
Rate = StrEnum("Rate", {"CD": "44100", "VIDEO": "48000"})
"""What can be heard, and samples a second."""


def command(
    files: Annotated[list[Path], typer.Argument(help="Result files.", metavar="RUN.h5")],
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="The file to write; default: RUN_WHAT.wav, in this folder.", metavar="WAV"),
    ] = None,
    what: Annotated[
        What, typer.Option(help="The sound: velocity, force, displacement, normal-velocity or load.", metavar="WHAT")
    ] = What.velocity,
    speed_up: Annotated[
        float | None,
        typer.Option(
            "--speed-up",
            help="Factor by which the sound is faster than the run; default: 1, of several runs an audible one.",
            metavar="X",
        ),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(help="Length of the sound, from the start; default: all.", metavar="S")
    ] = None,
    rate: Annotated[Rate, typer.Option(help="Samples a second: 44100 or 48000.", metavar="RATE")] = Rate.VIDEO,
    force: ReplaceFile = False,
) -> None:
    """Write the slider's motion as sound.

    Band-limited, without mean, peak at -3 dB, physical scale in the file.

    Several runs get one scale and one length, so that they differ in loudness as they do in motion.

    Example: rubnoise listen few.h5 many.h5 --speed-up 10
    """
    from rubnoise.analysis.sound import Sound, audible, level_of, on_one_scale
    from rubnoise.cli.loading import finished_run
    from rubnoise.storage.wave_file import check_length

    for option, value in (("--speed-up", speed_up), ("--seconds", seconds)):
        if value is not None and not (isfinite(value) and value > 0.0):
            raise typer.BadParameter(f"{option}: {value:g} is no number above 0")
    if output and len(files) > 1:
        raise typer.BadParameter("-o names one file; several runs are written as RUN_WHAT.wav in this folder")
    with ExitStack() as opened, stoppable() as between:
        runs = [opened.enter_context(finished_run(file)) for file in files]
        choose = partial(Sound.of, what=cast("Heard", what.value), rate=int(rate))
        sounds = [choose(run, speed_up=speed_up or 1.0, seconds=None) for run in runs]
        paths = [output or Path(f"{sound.file.path.stem}_{sound.what}.wav") for sound in sounds]
        _check_paths(files, paths, force=force)
        faster = speed_up or (audible(sounds[0], between) if len(sounds) > 1 else 1.0)
        choose = partial(choose, speed_up=faster)
        sounds = [choose(run, seconds=seconds) for run in runs]
        shortest = min(sound.seconds for sound in sounds)
        sounds = [sound if sound.seconds == shortest else choose(sound.file, seconds=shortest) for sound in sounds]
        for sound in sounds:
            check_length(sound.samples)
        levels = on_one_scale(level_of(sound, between) for sound in sounds)
        for path, sound, level in zip(paths, sounds, levels, strict=True):
            _write(path, sound, level, between, force=force)
            show(sound_answer(path, sound, level, others=len(sounds) - 1), as_json=False)


def _check_paths(files: list[Path], paths: list[Path], *, force: bool) -> None:
    """Raise Refused before anything is written if the sound of a file cannot be written to its path."""
    from rubnoise.storage.output import check_output

    for i, path in enumerate(paths):
        if path in paths[:i]:
            raise typer.BadParameter(f"{files[paths.index(path)]} and {files[i]} would both be written to {path}")
        if path.suffix.lower() != ".wav":
            raise typer.BadParameter(f"{path} does not end in .wav")
        check_output(path, force=force, reads=files)


def _write(path: Path, sound: "Sound", level: "Level", between: "Callable[[], None]", *, force: bool) -> None:
    from rubnoise.analysis.sound import samples_of
    from rubnoise.storage.output import whole_file
    from rubnoise.storage.wave_file import write_wave

    with whole_file(path, force=force) as part:
        chunks = samples_of(sound, level, between)
        write_wave(part, chunks, samples=sound.samples, rate=sound.rate, texts=wave_comments(sound, level))


def wave_comments(sound: "Sound", level: "Level") -> dict[str, str]:
    """Return the texts in a sound file: title, the scale of its samples, and the program that wrote it."""
    figures = {
        "quantity": sound.what,
        "unit": sound.units,
        "full_scale": repr(level.full_scale),
        "mean": repr(level.mean),
        "speed_up": repr(sound.speed_up),
        "sample_rate": str(sound.rate),
        "run": sound.file.path.name,
    }
    return {
        "INAM": str(sound.file.attributes["title"]) or sound.file.path.stem,
        "ICMT": "; ".join(f"{name}={text}" for name, text in figures.items()),
        "ISFT": f"rubnoise {__version__}",
    }


def sound_answer(path: Path, sound: "Sound", level: "Level", others: int = 0) -> Answer:
    """Return the file that was written, its scale, and its audible part; ``others`` have the same scale."""
    from rubnoise.analysis.hearing import Hearing
    from rubnoise.storage.wave_file import BITS

    whose = "the loudest sample of all runs" if others else "the loudest sample"
    rate = f"{grouped(sound.rate)} samples a second of {BITS} bits"
    hearing = None if level.spectrum is None else Hearing.of(level.spectrum)
    began = (Row(name="begins_at", value=sound.first * sound.tick_duration, unit="s", note="after the transient"),)
    heard = () if hearing is None else tuple(_audible(hearing, level))
    return Answer(
        title=f"{path}: {sound.seconds:.6g} s of {sound.what}, {rate}",
        rows=(*(began if sound.first else ()), *_scale(sound, level, whose), *heard),
        notes=_advice(hearing, sound.speed_up),
    )


def _scale(sound: "Sound", level: "Level", whose: str) -> Iterator[Row]:
    yield Row(name="speed_up", value=sound.speed_up)
    yield Row(name="full_scale", value=level.full_scale, unit=sound.units, note=f"{whose} 3 dB below")
    yield Row(name="mean", value=level.mean, unit=sound.units, note="taken away")
    if sound.natural is not None:
        heard = f"heard at {sound.natural * sound.speed_up:.4g} Hz"
        yield Row(name="natural_frequency", value=sound.natural, unit="Hz", note=heard)


def _audible(hearing: "Hearing", level: "Level") -> Iterator[Row]:
    yield Row(name="middle", value=hearing.middle, unit="Hz", note="half of the power lies below")
    yield Row(name="audible_share", value=hearing.audible, note="20 Hz to 20 kHz")
    yield Row(name="level", value=level.laptop, unit="dB", note="re full scale, 200 to 4000 Hz: what a laptop plays")


def _advice(hearing: "Hearing | None", speed_up: float) -> tuple[str, ...]:
    """Return advice for a sound that most ears and small loudspeakers miss."""
    if hearing is None:
        return ("too short to estimate the audible part",)
    better = hearing.better(speed_up)
    if better is None:
        return ()
    if hearing.audible < 0.01:
        problem = "next to nothing of it can be heard"
    elif hearing.middle < 100.0:
        problem = "most of it is deeper than small loudspeakers go"
    else:
        problem = "most of it is higher than many can hear"
    middle = hearing.middle * better / speed_up
    return (f"{problem}; --speed-up {better:g} would bring the middle to {middle:.3g} Hz",)
