"""`rubnoise listen`: the motion of the slider as a sound file."""

from contextlib import ExitStack
from enum import StrEnum
from functools import partial
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from rubnoise import __version__
from rubnoise.answer import Answer, rows
from rubnoise.cli.layout import show
from rubnoise.cli.options import NewFile, ReplaceFile, argument, option, output
from rubnoise.cli.progress import stoppable

if TYPE_CHECKING:
    from rubnoise.analysis.sound import Heard, Sound


What = StrEnum("What", "velocity force displacement normal-velocity load")
Rate = StrEnum("Rate", {"CD": "44100", "VIDEO": "48000"})
"""What can be heard, and samples a second."""


def listen(
    files: Annotated[list[Path], argument("RUN.h5", "Result files.")],
    *,
    output: Annotated[NewFile, output("WAV", "The file to write; default: RUN_WHAT.wav, in this folder.")] = None,
    what: Annotated[What, option("WHAT", f"The sound: {', '.join(What)}.")] = What.velocity,
    speed_up: Annotated[
        float | None, option("X", "How much faster than the run; default: 1, of several runs what is audible.")
    ] = None,
    seconds: Annotated[float | None, option("S", "Length of the sound, from the start; default: all.")] = None,
    rate: Annotated[Rate, option("RATE", "Samples a second: 44100 or 48000.")] = Rate.VIDEO,
    force: ReplaceFile = False,
) -> None:
    """Write the slider's motion as sound.

    Band-limited, without mean, peak at -3 dB, physical scale in the file.

    Several runs get one scale and one length, so that they differ in loudness as they do in motion.

    Example: rubnoise listen few.h5 many.h5 --speed-up 10
    """
    from rubnoise.analysis.sound import Sound
    from rubnoise.cli.loading import finished_run
    from rubnoise.storage.output import whole_file
    from rubnoise.storage.sound import write_wave

    for name, value in (("--speed-up", speed_up), ("--seconds", seconds)):
        if value is not None and not (isfinite(value) and value > 0.0):
            raise typer.BadParameter(f"{name}: {value:g} is no number above 0")
    if output and len(files) > 1:
        raise typer.BadParameter("-o names one file; several runs are written as RUN_WHAT.wav in this folder")
    with ExitStack() as opened, stoppable() as between:
        runs = [opened.enter_context(finished_run(file)) for file in files]
        choose = partial(Sound.of, what=cast("Heard", what.value), rate=int(rate))
        if speed_up is None and len(runs) > 1:
            speed_up = choose(runs[0], speed_up=1.0).better
        sounds = [choose(run, speed_up=speed_up or 1.0) for run in runs]
        paths = [output or Path(f"{sound.file.path.stem}_{sound.what}.wav") for sound in sounds]
        _check_paths(files, paths, force=force)
        shortest = seconds or min(sound.seconds for sound in sounds)
        sounds = [sound.lasting(shortest) for sound in sounds]
        full_scale = 0.0  # that of the loudest, so that loudness compares runs
        for sound in sounds:
            between()
            full_scale = max(full_scale, sound.full_scale)
        for path, sound in zip(paths, sounds, strict=True):
            pieces, texts = sound.pieces(full_scale, between), _wave_comments(sound, full_scale)
            with whole_file(path, force=force) as part, part.open("w+b") as stream:
                write_wave(stream, pieces, samples=sound.samples, rate=sound.rate, texts=texts)
            show(_answer(path, sound, full_scale, others=len(sounds) - 1))


def _check_paths(files: list[Path], paths: list[Path], *, force: bool) -> None:
    """Raise Refused before anything is written if the sound of a file cannot be written to its path."""
    from rubnoise.storage.output import check_output

    for i, path in enumerate(paths):
        if path in paths[:i]:
            raise typer.BadParameter(f"{files[paths.index(path)]} and {files[i]} would both be written to {path}")
        if path.suffix.lower() != ".wav":
            raise typer.BadParameter(f"{path} does not end in .wav")
        check_output(path, force=force, reads=files)


def _wave_comments(sound: "Sound", full_scale: float) -> dict[str, str]:
    """Return the texts in a sound file: title, the scale of its samples, and the program that wrote it."""
    figures = {
        "quantity": sound.what,
        "unit": sound.units,
        "full_scale": repr(full_scale),
        "mean": repr(sound.mean),
        "speed_up": repr(sound.speed_up),
        "sample_rate": str(sound.rate),
        "run": sound.file.path.name,
    }
    return {
        "INAM": str(sound.file.attributes["title"]) or sound.file.path.stem,
        "ICMT": "; ".join(f"{name}={text}" for name, text in figures.items()),
        "ISFT": f"rubnoise {__version__}",
    }


def _answer(path: Path, sound: "Sound", full_scale: float, others: int) -> Answer:
    """Return the file that was written, its scale, and its audible part; ``others`` have the same scale."""
    from rubnoise.storage.sound import BITS

    whose = "the loudest sample of all runs" if others else "the loudest sample"
    heard = sound.hearing
    told = rows(
        "",
        ("begins_at", sound.first * sound.tick_duration or None, "s", "after the transient"),
        ("speed_up", sound.speed_up),
        ("full_scale", full_scale, sound.units, f"{whose} 3 dB below"),
        ("mean", sound.mean, sound.units, "taken away"),
        ("natural_frequency", sound.natural, "Hz", f"heard at {(sound.natural or 0.0) * sound.speed_up:.4g} Hz"),
        ("middle", heard and heard.middle, "Hz", "half of the power lies below"),
        ("audible_share", heard and heard.audible, "", "20 Hz to 20 kHz"),
        ("level", sound.laptop_level(full_scale), "dB", "re full scale, 200 to 4000 Hz: what a laptop plays"),
    )
    title = f"{path}: {sound.seconds:.6g} s of {sound.what}, {sound.rate:,} samples a second of {BITS} bits"
    return Answer(title=title, rows=tuple(told), notes=_advice(sound))


def _advice(sound: "Sound") -> tuple[str, ...]:
    """Return advice for a sound that most ears and small loudspeakers miss."""
    heard = sound.hearing
    if heard is None:
        return ("too short to estimate the audible part",)
    if sound.better is None:
        return ()
    if heard.audible < 0.01:
        problem = "next to nothing of it can be heard"
    elif heard.middle < 100.0:
        problem = "most of it is deeper than small loudspeakers go"
    else:
        problem = "most of it is higher than many can hear"
    middle = heard.middle * sound.better / sound.speed_up
    return (f"{problem}; --speed-up {sound.better:g} would bring the middle to {middle:.3g} Hz",)
