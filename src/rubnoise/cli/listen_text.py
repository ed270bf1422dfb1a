"""What is said about a sound, on the terminal and in the file itself."""

from pathlib import Path

from rubnoise import __version__
from rubnoise.analysis.sound import Hearing, Level, Sound
from rubnoise.cli.layout import grouped, line, number, remark
from rubnoise.cli.terminal import sentence
from rubnoise.storage.wave_file import BITS


def comments(sound: Sound, level: Level) -> dict[str, str]:
    """Return the texts that a sound carries: title, what its samples stand for, and who wrote it."""
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


def told(path: Path, sound: Sound, level: Level) -> list[str]:
    """Return what was written, its scale, and what of it can be heard."""
    rate = f"{grouped(sound.rate)} samples a second of {BITS} bits"
    return [
        sentence(f"{path}: {sound.seconds:.6g} s of {sound.what}, {rate}"),
        line("speed-up", number(sound.speed_up)),
        line("full scale", f"{number(level.full_scale)} {sound.units}, the loudest sample 3 dB below"),
        line("mean, taken away", f"{number(level.mean)} {sound.units}"),
        *_natural(sound),
        *_heard(sound, level),
    ]


def _natural(sound: Sound) -> list[str]:
    if sound.natural is None:
        return []
    return [line("natural frequency", f"{number(sound.natural)} Hz, heard at {sound.natural * sound.speed_up:.4g} Hz")]


def _heard(sound: Sound, level: Level) -> list[str]:
    if level.spectrum is None:
        return [remark("too short to estimate the audible part")]
    hearing = Hearing.of(level.spectrum)
    lines = [
        line("half of the power below", f"{hearing.middle:.3g} Hz"),
        line("audible, 20 Hz to 20 kHz", f"{100.0 * hearing.audible:.3g} % of the power"),
    ]
    better = hearing.better(sound.speed_up)
    return lines if better is None else [*lines, remark(_advice(hearing, sound.speed_up, better))]


def _advice(hearing: Hearing, speed_up: float, better: float) -> str:
    """Return what to do about a sound that most ears and small loudspeakers miss."""
    if hearing.audible < 0.01:
        told = "next to nothing of it can be heard"
    elif hearing.middle < 100.0:
        told = "most of it is deeper than small loudspeakers go"
    else:
        told = "most of it is higher than many can hear"
    return f"{told}; --speed-up {better:g} would bring the middle to {hearing.middle * better / speed_up:.3g} Hz"
