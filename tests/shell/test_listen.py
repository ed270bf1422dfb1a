"""`rubnoise listen`: a run as sound."""

import signal
import subprocess
import time
import wave
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.shell.terminal import call, command, names, start, stop

# `rubnoise listen`: a run as sound.
CONTACT = Path("../given/contact.toml")
SLIDER = Path("../given/slider.toml")
STEPS = 1 << 23


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", SLIDER, "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


def _samples(path: Path) -> np.ndarray:
    with wave.open(str(path)) as file:
        assert (file.getnchannels(), file.getsampwidth()) == (1, 3)
        packed = np.frombuffer(file.readframes(file.getnframes()), np.uint8).reshape(-1, 3)
    padded = np.zeros((len(packed), 4), np.uint8)
    padded[:, 1:] = packed
    return padded.view("<i4")[:, 0] / 256.0 / STEPS


def _comment(path: Path) -> dict[str, str]:
    """Return the figures of the chunk ICMT."""
    data = path.read_bytes()
    place = data.index(b"ICMT")
    size = int.from_bytes(data[place + 4 : place + 8], "little")
    text = data[place + 8 : place + 8 + size].rstrip(b"\0").decode()
    return dict(each.split("=", 1) for each in text.split("; "))


def test_the_velocity_is_heard_where_nothing_is_said(result: Path, here: Path) -> None:
    answer = call("listen", "x.h5")
    assert (answer.code, answer.err) == (0, "")
    first, *lines = answer.out.splitlines()
    assert first == "x_velocity.wav: 0.300021 s of velocity, 48,000 samples a second of 24 bits"
    assert names(here) == ["x.h5", "x_velocity.wav"]
    assert any("natural frequency" in each and "heard at 38.98 Hz" in each for each in lines)
    assert any("audible share" in each and "20 Hz to 20 kHz" in each for each in lines)


@pytest.mark.parametrize("words", [(), ("--what", "velocity"), ("--what", "normal-velocity")])
def test_the_velocity_of_a_load_alone_is_called_normal(here: Path, words: tuple[str, ...]) -> None:
    assert call("run", "load/bouncing", "-q", "-o", "b.h5", "--set", "sliding.distance=1 mm").code == 0
    answer = call("listen", "b.h5", *words)
    assert answer.code == 0
    assert answer.out.startswith("b_normal-velocity.wav: ")
    assert " s of normal-velocity, " in answer.out.splitlines()[0]
    assert names(here) == ["b.h5", "b_normal-velocity.wav"]
    assert _comment(here / "b_normal-velocity.wav")["quantity"] == "normal-velocity"


@pytest.mark.parametrize("what", ["velocity", "force", "displacement"])
def test_the_file_tells_the_physical_scale(result: Path, here: Path, what: str) -> None:
    answer = call("listen", "x.h5", "--what", what, "-o", "a.wav")
    assert answer.code == 0
    told = _comment(here / "a.wav")
    scale, mean = float(told.pop("full_scale")), float(told.pop("mean"))
    unit = {"velocity": "um/s", "force": "uN", "displacement": "um"}[what]
    assert told == {"quantity": what, "unit": unit, "speed_up": "1.0", "sample_rate": "48000", "run": "x.h5"}
    assert f"{scale:.7g} {unit} (the loudest sample 3 dB below)" in answer.out
    samples = _samples(here / "a.wav")
    assert np.abs(samples).max() == pytest.approx(10.0 ** (-3.0 / 20.0), abs=1e-6)
    with h5py.File(result) as file:
        values = file["slider"][{"force": "friction_force"}.get(what, what)][:]
    # Every 24th sample lies at every 5th tick; what is above 0.9 of the ticks' half may be missing.
    found, wanted = (mean + scale * samples)[::24], values[::5]
    assert np.abs(found - wanted)[20:-20].max() < 2e-3 * np.abs(values - mean).max()


@pytest.mark.slow
def test_compared_runs_differ_in_loudness_as_they_do_in_motion(result: Path, here: Path) -> None:
    """In the band that a laptop plays too: at the speed-up that is taken by default."""
    quiet = ("--set", "interface.mean_junction_count=80")
    assert call("run", SLIDER, "-q", "-o", "y.h5", *quiet, "--set", "sliding.distance=0.25 mm").code == 0
    answer = call("listen", "x.h5", "y.h5")
    assert (answer.code, answer.err) == (0, "")
    assert names(here) == ["x.h5", "x_velocity.wav", "y.h5", "y_velocity.wav"]
    told = [_comment(here / f"{name}_velocity.wav") for name in "xy"]
    assert told[0]["full_scale"] == told[1]["full_scale"]
    samples = [_samples(here / f"{name}_velocity.wav") for name in "xy"]
    assert samples[0].size == samples[1].size
    spreads = []
    for name in "xy":
        with h5py.File(here / f"{name}.h5") as file:
            spreads.append(float(np.std(file["slider/velocity"][:])))
    wanted = 20.0 * np.log10(spreads[0] / spreads[1])
    levels = [float(each.split()[1]) for each in answer.out.splitlines() if each.startswith("  level ")]
    # Chosen: runs of 0.25 mm hold so few swings that the share of each in the band is known to some 12 %, half a dB.
    assert levels[0] - levels[1] == pytest.approx(wanted, abs=1.0)
    assert abs(wanted) > 3.0
    assert call("listen", "x.h5", "x.h5").code == 2
    assert call("listen", "x.h5", "y.h5", "-o", "z.wav").code == 2


def test_a_force_that_never_varies_makes_no_sound(here: Path) -> None:
    constant = ("birth.law=regular", "pulse.shape=triangle", "sliding.speed=1 mm/s", "strength.mean=1 MPa")
    given = [word for change in constant for word in ("--set", change)]
    assert call("run", CONTACT, "-q", "-o", "x.h5", *given).code == 0
    answer = call("listen", "x.h5", "--what", "force")
    assert (answer.code, answer.err) == (2, "x.h5: the force does not vary, so there is nothing to hear\n")


@pytest.mark.slow
def test_a_signal_leaves_nothing_behind(here: Path) -> None:
    assert call("run", SLIDER, "-q", "-o", "x.h5", "--set", "sliding.distance=6 mm").code == 0
    # A hundredth of the true speed: ten minutes of sound, which take a while to write.
    slowly = command("listen", "x.h5", "--speed-up", "0.01")
    listening: subprocess.Popen[str] = start(slowly, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while listening.poll() is None and not (here / "x_velocity.wav.part").exists():
        time.sleep(0.002)
    answer = stop(listening, signal.SIGTERM)
    assert (answer.code, answer.err) == (
        143,
        "stopped by a signal; nothing was kept, and the same command begins again\n",
    )
    assert names(here) == ["x.h5"]
