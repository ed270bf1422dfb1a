"""Tables of text as laboratories write them, and as nobody should: one reader for `infer`, Trace and pictures."""

from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused, in_shell
from rubnoise.storage.measured import Asked
from tests.inference.traces import read_measured
from tests.shell.terminal import call

COUNT = 40
TIMES = [f"{0.01 * n:.2f}" for n in range(COUNT)]
FORCES = [f"{50.0 + np.sin(n):.4f}" for n in range(COUNT)]
VALUES = [float(each) for each in FORCES]


def rows(separator: str = ",", *, comma: bool = False) -> str:
    text = "\n".join(f"{t}\t{f}" for t, f in zip(TIMES, FORCES, strict=True))
    return (text.replace(".", ",") if comma else text).replace("\t", separator)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_preamble_of_numbers_is_no_data(tmp_path: Path, count: int) -> None:
    path = tmp_path / "a.csv"
    path.write_text("".join(f"{n}\n" for n in range(count)) + "force (N)\n" + "\n".join(FORCES), encoding="utf-8")
    read = read_measured(path, Asked(rate=100.0))
    assert (read.values.tolist(), read.head.unit, read.place(0)) == (VALUES, "N", f"line {count + 2}")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("time (s),force (N)\nx,y\n", 2),
        ("time (s),force (N)\n0.00,x\n", 2),
        ("time (s),force (N)\n,\n", 2),
        ("time (s),force (N)\n0.00\n", 2),
        ("time (s),force (N)\n0.00,1,2\n", 2),
        ("time (s),force (N)\nerror\n0.00,x\n", 2),
        ("Messung\ntime (s),force (N)\ns,parsec\n", 3),
        ("time,force\ns,N\n0.00,x\n", 3),
        ("0.00,x\n", 1),
        ("0.00,\n", 1),
    ],
)
def test_damaged_first_rows_are_neither_preamble_nor_names(tmp_path: Path, text: str, line: int) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text + rows(), encoding="utf-8")
    for read in (read_measured, rubnoise.Trace.from_csv):
        with pytest.raises(Refused) as refused:
            read(path)
        if "no line of names" not in str(refused.value):
            assert f"a.csv: line {line}: " in str(refused.value)


def test_data_are_never_taken_for_names(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(rows() + "\n", encoding="utf-8")
    with pytest.raises(Refused, match=r'has no line of names .*column=2, rate="10 kHz" and unit="N"') as refused:
        read_measured(path)
    assert '--column 2, --rate "10 kHz" and --unit N' in in_shell(str(refused.value))
    read = read_measured(path, Asked(column="2", rate=100.0))
    assert (read.values.tolist(), read.step, read.head.unit, read.place(0)) == (VALUES, 0.01, "", "line 1")
    with pytest.raises(Refused, match="has no line of names above its numbers"):
        rubnoise.Trace.from_csv(path)
    for words, missing in (
        (["--column", "2", "--rate", "100 Hz"], "--unit mN"),
        (["--column", "2", "--unit", "N"], '--rate "20 kHz"'),
    ):
        answer = call("infer", str(path), "--speed", "1 mm/s", *words)
        assert (answer.code, missing in answer.err) == (2, True)
    words = ["--column", "2", "--unit", "N", "--rate", "100 Hz"]
    assert call("infer", str(path), "--speed", "1 mm/s", *words).code == 3  # 40 samples are too few
    path.write_text("\n".join(FORCES), encoding="utf-8")
    assert read_measured(path, Asked(rate=100.0)).values.tolist() == VALUES


def test_times_rounded_to_three_decimals_are_read_with_a_rate(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = [f"{n / 10_000:.3f},{value}" for n, value in enumerate(VALUES * 10)]
    path.write_text("\n".join(["time (s),force (N)", *lines]), encoding="utf-8")
    with pytest.raises(Refused, match=r'time does not grow .*rate="10 kHz"'):
        read_measured(path)
    assert read_measured(path, Asked(rate=10_000.0)).step == pytest.approx(1e-4, rel=1e-12)
    assert rubnoise.Trace.from_csv(path, rate="10 kHz").step == pytest.approx(1e-4, rel=1e-12)
    outranked = read_measured(path, Asked(rate=8_000.0))
    assert outranked.step == 1.0 / 8_000.0
    assert "the rate is 8000 Hz as given; by time of" in outranked.notes[0]
