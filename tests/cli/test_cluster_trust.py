"""What docs/cluster.md says of trust: where Dask listens after its commands, and that TLS keeps others out."""

import json
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from shlex import split

import pytest

import rubnoise
from rubnoise.sweep import cluster
from tests.architecture.sources import ROOT
from tests.cli.swept import TABLE, runs_of
from tests.cli.terminal import CONTACT, Answer, call, spawn

pytest.importorskip("distributed", reason="the extra cluster is not installed")

PAGE = (ROOT / "docs" / "cluster.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```text\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
LINES = [line for block in BLOCKS for line in block.splitlines()]
PROC = Path("/proc/self/net/tcp")
OPTIONS = ("--tls-ca-file", "cert.pem", "--tls-cert", "cert.pem", "--tls-key", "key.pem")


def _command(beginning: str, *, tls: bool) -> list[str]:
    """Return the words of a command of the page, for this machine and one worker."""
    line = next(line for line in LINES if line.startswith(beginning) and ("--tls-cert" in line) is tls)
    line = re.sub(r"\b10\.0\.0\.\d+", "127.0.0.1", line.removesuffix(" &"))
    return split(line.replace("--nworkers 16", "--nworkers 1").replace("--port 8786", "--port 0"))


@pytest.fixture
def started(here: Path) -> Iterator["Dask"]:
    (here / "s.toml").write_text(CONTACT + TABLE, encoding="utf-8")
    with ExitStack() as ending:
        yield Dask(ending)


class Dask:
    """Processes of Dask that end with a test."""

    def __init__(self, ending: ExitStack) -> None:
        self._ending = ending

    def start(self, *words: str) -> int:
        """Start `dask scheduler ...` or `dask worker ...`, and return its process number."""
        program = [sys.executable, "-m", f"distributed.cli.dask_{words[1]}", *words[2:]]
        process = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._ending.callback(process.wait)
        self._ending.callback(process.terminate)  # so that a worker ends its own processes too
        return process.pid

    def cluster(self, *, tls: bool, file: str = "scheduler.json") -> tuple[str, list[int]]:
        """Start scheduler and workers by the page's commands; return the address, and the numbers of all processes."""
        words = _command("dask scheduler", tls=tls)
        boss = self.start(*words, *(() if "--scheduler-file" in words else ("--scheduler-file", file)))
        _until(Path(file).exists)
        address = str(json.loads(Path(file).read_text(encoding="utf-8"))["address"])
        words = [address if word.startswith("tls://") else word for word in _command("dask worker", tls=tls)]
        worker = self.start(*words)
        _until(lambda: sum(bool(_listening([process])) for process in _family(worker)) >= 2)  # and its nanny
        return address, [boss, *_family(worker)]


def _until(reached: Callable[[], bool]) -> None:
    last = time.monotonic() + 120.0
    while not reached():
        assert time.monotonic() < last
        time.sleep(0.5)


def _family(process: int) -> list[int]:
    """Return a process and all that it has started, as Linux lists them."""
    own: list[str] = []
    with suppress(OSError):  # a thread that ends meanwhile
        for task in Path(f"/proc/{process}/task").iterdir():
            own += (task / "children").read_text(encoding="ascii").split()
    return [process, *(number for child in own for number in _family(int(child)))]


def _listening(processes: list[int]) -> set[str]:
    """Return the addresses on which processes listen, as hexadecimal numbers of the system."""
    entries = [entry for process in processes for entry in _entries(process)]
    sockets = {link[8:-1] for entry in entries if (link := _target(entry)).startswith("socket:[")}
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/self/net/{table}").read_text(encoding="ascii").splitlines()[1:]:
            words = line.split()
            if words[3] == "0A" and words[9] in sockets:
                found.add(words[1].partition(":")[0])
    return found


def _entries(process: int) -> list[Path]:
    try:
        return list(Path(f"/proc/{process}/fd").iterdir())
    except OSError:  # it has ended
        return []


def _target(entry: Path) -> str:
    try:
        return str(entry.readlink())
    except OSError:
        return ""


LOOPBACK, EVERYWHERE = "0100007F", {"00000000", "0" * 32}


@pytest.mark.skipif(not PROC.exists(), reason="only Linux lists its sockets in files")
def test_the_scheduler_of_the_page_listens_on_one_address(started: Dask) -> None:
    boss = started.start(*_command("dask scheduler", tls=False))
    _until(Path("scheduler.json").exists)
    assert _listening([boss]) == {LOOPBACK}


@pytest.mark.skipif(not PROC.exists(), reason="only Linux lists its sockets in files")
def test_the_commands_of_the_page_bind_everything_to_one_address(started: Dask) -> None:
    _, processes = started.cluster(tls=False)
    answer = spawn(*_swept(_command("rubnoise sweep", tls=False)))
    assert (answer.code, answer.out) == (0, "afar: 2 points, 6 runs: 6 done\n"), answer.err
    assert len(processes) >= 3
    assert _listening(processes) == {LOOPBACK}


@pytest.mark.skipif(not PROC.exists(), reason="only Linux lists its sockets in files")
def test_without_the_option_for_http_the_same_scheduler_is_open_to_all(started: Dask) -> None:
    port = ("--port", "0", "--scheduler-file", "open.json")
    boss = started.start("dask", "scheduler", "--host", "127.0.0.1", "--no-dashboard", *port)
    _until(Path("open.json").exists)
    found = _listening([boss])
    assert LOOPBACK in found
    assert found & EVERYWHERE


def _swept(words: list[str], address: str = "") -> list[str]:
    """Return the arguments of the page's sweep for the file and folder of these tests."""
    names = {"fig7.toml": "s.toml", "/shared/fig7": "afar"}
    return [names.get(word, address if word.startswith("tls://") else word) for word in words[1:]]


def _certificate(name: str) -> None:
    line = next(line for line in LINES if line.startswith("openssl"))
    words = split(line.replace("key.pem", f"{name}key.pem").replace("cert.pem", f"{name}cert.pem"))
    subprocess.run(words, check=True, capture_output=True)


needs_openssl = pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl, which makes the keys, is missing")


@needs_openssl
def test_a_sweep_over_tls_gives_the_same_bits_and_lets_nobody_else_in(
    started: Dask, monkeypatch: pytest.MonkeyPatch
) -> None:
    _certificate("")
    _certificate("other_")
    assert Path("key.pem").stat().st_mode & 0o077 == 0
    address, processes = started.cluster(tls=True)
    assert address.startswith("tls://127.0.0.1:")
    answer = spawn(*_swept(_command("rubnoise sweep", tls=True), address))
    assert (answer.code, answer.out) == (0, "afar: 2 points, 6 runs: 6 done\n"), answer.err
    assert call("sweep", "s.toml", "-o", "near", "--jobs", "1", "-q").code == 0
    assert runs_of(Path("afar")) == runs_of(Path("near"))
    if PROC.exists():
        assert _listening(processes) == {LOOPBACK}

    from distributed import Security

    security = Security(
        require_encryption=True, tls_ca_file="cert.pem", tls_client_cert="cert.pem", tls_client_key="key.pem"
    )
    with rubnoise.run_sweep("s.toml", "python", cluster=address, security=security) as sweep:
        assert sweep.count("done") == 6
    assert runs_of(Path("python")) == runs_of(Path("near"))

    monkeypatch.setattr(cluster, "PATIENCE", 3.0)
    strangers = [word.replace("cert.pem", "other_cert.pem").replace("key.pem", "other_key.pem") for word in OPTIONS]
    for words, said in (
        ((), "uses TLS; --tls-ca-file, --tls-cert and --tls-key name the files for it"),
        (strangers, "TLS certificate does not match"),
    ):
        _is_refused(call("sweep", "s.toml", "-o", "no", "--cluster", address, *words), said)
    plain = address.replace("tls:", "tcp:")
    _is_refused(call("sweep", "s.toml", "-o", "no", "--cluster", plain), "no scheduler answers")
    _hangs_up(address)


def _is_refused(answer: Answer, said: str) -> None:
    assert (answer.code, answer.out) == (2, "")
    assert said in answer.err
    assert not Path("no").exists() or not runs_of(Path("no"))


def _hangs_up(address: str) -> None:
    """Assert that a connection which speaks no TLS is not answered."""
    host, _, port = address.removeprefix("tls://").partition(":")
    with socket.create_connection((host, int(port)), timeout=10.0) as line:
        try:
            line.sendall(bytes(1000))
            answered = line.recv(1000)
        except ConnectionError:
            answered = b""
    assert len(answered) <= 16  # an alert of TLS at most


@needs_openssl
def test_what_cannot_be_spoken_over_tls_is_refused_before_anything_is_sent(
    started: Dask, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    _certificate("")
    _certificate("other_")
    Path("plain.json").write_text('{"address": "tcp://127.0.0.1:9"}', encoding="utf-8")
    Path("odd.json").write_text("[]", encoding="utf-8")
    mixed = (*OPTIONS[:-1], "other_key.pem")
    for words, said in (
        (("--cluster", "tcp://127.0.0.1:9", *OPTIONS), "does not use TLS: its address is tcp://127.0.0.1:9"),
        (("--cluster", "plain.json", *OPTIONS), "plain.json: does not use TLS: its address is tcp://127.0.0.1:9"),
        (("--cluster", "127.0.0.1:9", *OPTIONS), "127.0.0.1:9: no scheduler answers there"),
        (("--cluster", "odd.json"), "odd.json: is no file of a scheduler"),
        (("--cluster", "tls://127.0.0.1:9"), "uses TLS; --tls-ca-file, --tls-cert and --tls-key name the files"),
        (OPTIONS, "--tls-ca-file, --tls-cert and --tls-key are for --cluster"),
        (("--cluster", "tls://127.0.0.1:9", *OPTIONS[:2]), "--tls-ca-file and --tls-cert go together"),
        (("--cluster", "tls://127.0.0.1:9", *mixed), "of no use together: key values mismatch"),
        (
            ("--cluster", "tls://127.0.0.1:9", *OPTIONS[:-1], "none.pem"),
            "--tls-key: none.pem: no such file or directory",
        ),
    ):
        answer = call("sweep", "s.toml", "-o", "no", *words)
        assert (answer.code, answer.out) == (2, ""), words
        assert said in " ".join(re.sub("[│\\s]+", " ", answer.err).split()), words
        assert not Path("no", "runs").exists() or not runs_of(Path("no"))


def test_security_without_a_cluster_is_refused(here: Path) -> None:
    (here / "s.toml").write_text(CONTACT + TABLE, encoding="utf-8")
    with pytest.raises(rubnoise.Refused, match="security=: is for a cluster"):
        rubnoise.run_sweep("s.toml", "no", security=object())
    assert not Path("no").exists()
