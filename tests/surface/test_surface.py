"""Surfaces: reading, filters, exact theory, counting and the scenario that stands for them."""

from dataclasses import replace
from math import log10, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage
from scipy.special import erfc, ndtri

import rubnoise
from rubnoise.scenario import loads
from rubnoise.surface.gaussian import GaussianContact, filtered_variance, half_width
from rubnoise.surface.height_map import HeightMap, Waves, self_affine, without_form
from rubnoise.surface.sliding import SlidingContact, patches
from rubnoise.theory.coupling import load_motion, overlap_scale
from tests.oracle.sliding_surfaces import areas_at, heights_at, patch_counts, slid
from tests.shell.terminal import call

N = 512


def spectrum(hurst, points=N, rolloff=128.0, cutoff=16.0, across=1.0):
    """The spectrum of the reference: both surfaces alike, variance 1/2; longer waves across than along on request."""
    f = np.fft.fftfreq(points)
    q = np.hypot(f[:, None], across * f[None, :])
    power = np.where((q > 0) & (q <= 1 / cutoff), np.maximum(q, 1 / rolloff) ** (-2 - 2 * hurst), 0.0)
    return power / (2 * power.sum())


def surface(power, rng):
    """A Gaussian surface of a spectrum; its rms height is not forced to anything."""
    noise = np.fft.fft2(rng.standard_normal(power.shape))
    return np.fft.ifft2(noise * np.sqrt(power * power.size)).real


def contact(hurst, share, points=N):
    waves = Waves(spectrum(hurst, points), (1.0, 1.0))
    return GaussianContact(waves, waves, share, float(points * points), 1e9)


# Hurst exponent, share, and of a second program: N, births, mean life, std/mean sqrt(N) of an ensemble and within
# half a period, R(256)/R(0), half-width read off a grid, frozen share and std/mean sqrt(N) of a long run (four digits).
REFERENCE = [
    (0.8, 0.03, 20.53391094, 0.342683949, 59.9208425,
     1.269262651, 0.9924787775, 0.3885802603, 32.48059339, 0.1958, 1.1383),
    (0.8, 0.01, 9.948567554, 0.2333930595, 42.62580719,
     1.507375089, 1.231997845, 0.3319988209, 31.33912262, 0.1679, 1.3751),
    (0.8, 0.003, 4.03383984, 0.1189528258, 33.91125696,
     1.62453586, 1.394699985, 0.2629397536, 29.56642803, 0.1334, 1.5123),
    (0.5, 0.01, 16.51888902, 0.4993652998, 33.07976952,
     1.585012796, 1.286812307, 0.3408794294, 28.72760964, 0.1721, 1.4422),
    (0.8, 0.0001, 0.2362165354, 0.01008143739, 23.43083891,
     1.642262721, 1.554236386, 0.1043282545, 23.83950366, 0.0534, 1.5978),
]  # fmt: skip


@pytest.mark.parametrize("row", REFERENCE, ids=lambda row: f"H{row[0]}-{row[1]}")
def test_theory_of_the_reference_spectrum(row):
    hurst, share, count, births, life, ensemble, short, left, half, frozen, long = row
    found = contact(hurst, share)
    assert found.level == pytest.approx(-ndtri(share), rel=1e-14)
    assert (found.junction_count, found.birth_rate, found.mean_life) == pytest.approx((count, births, life), rel=1e-8)
    total, half_period = (found.ensemble_covariance(shift) for shift in (0, 256))
    root = sqrt(count) / found.real_contact_area
    assert sqrt(total) * root == pytest.approx(ensemble, rel=1e-7)
    assert sqrt(total - half_period) * root == pytest.approx(short, rel=1e-7)
    assert half_period / total == pytest.approx(left, rel=1e-7)
    assert found.frozen_share == pytest.approx(frozen, abs=6e-5)
    assert found.relative_std * sqrt(count) == pytest.approx(long, abs=6e-5)
    lags = np.arange(64.0)
    assert half_width(lags, np.array([found.ensemble_covariance(int(s)) for s in lags]) - half_period) == pytest.approx(
        half, rel=1e-3
    )


def test_track_and_slider_may_change_places():
    """R is symmetric in both surfaces; which of them is frozen is not."""
    ground, rough = Waves(spectrum(0.8, 256, across=3.0), (1.0, 1.0)), Waves(spectrum(0.5, 256), (1.0, 1.0))
    one, other = (GaussianContact(*pair, 0.01, 256.0**2, 256.0) for pair in ((ground, rough), (rough, ground)))
    assert one.ensemble_covariance(9) == pytest.approx(other.ensemble_covariance(9), rel=1e-12)
    assert one.frozen_variances == pytest.approx(other.frozen_variances[::-1], rel=1e-12)
    assert one.birth_rate == pytest.approx(other.birth_rate, rel=1e-12)


@pytest.mark.slow
def test_one_map_says_what_its_spectrum_says():
    """A periodogram scatters; what this adds to squares is taken away. The raw frozen share is too large."""
    rng = np.random.default_rng(5)
    exact, found, raw = contact(0.8, 0.01), [], []
    for _ in range(12):
        waves = [
            Waves.of(HeightMap(heights=surface(spectrum(0.8), rng), spacing=(1.0, 1.0), periodic=True)) for _ in (0, 1)
        ]
        one = GaussianContact(*waves, 0.01, float(N * N), 1e9)
        found.append(one.frozen_share)
        raw.append(GaussianContact(*(replace(w, scatter=None) for w in waves), 0.01, float(N * N), 1e9).frozen_share)
    error = np.std(found) / sqrt(len(found))
    assert abs(np.mean(found) - exact.frozen_share) < 4 * error
    assert np.mean(raw) - exact.frozen_share > 4 * error


@pytest.mark.slow
def test_two_paraboloids_make_one_parabolic_life():
    """Radius R, peak overlap delta: A(s) = pi R (delta - s^2/(4 R)), life 4 sqrt(R delta); a pass off by b has less."""
    x = np.arange(256.0)[:, None] - 128
    y = np.arange(256.0)[None, :] - 128
    radius, delta = 400.0, 1.0
    for b in (0.0, 20.0):
        bump, other = -(x**2 + y**2) / (2 * radius), -((x + 60.0) ** 2 + (y - b) ** 2) / (2 * radius)
        found = slid(bump, other, -delta, 120)
        peak = delta - b * b / (4 * radius)
        assert found.areas.shape[0] == 1
        assert found.lives[0] == pytest.approx(4 * sqrt(radius * peak), abs=2)
        s = np.arange(120) - 60
        exact = pi * radius * np.maximum(peak - s**2 / (4 * radius), 0)
        assert np.abs(found.total - exact).max() < 0.03 * pi * radius * peak


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.03, 0.01, 0.003])
def test_theory_holds_against_brute_force(share):
    """12 pairs of maps: area, number, and variances within one run and between sliders; 4 of them for births."""
    rng = np.random.default_rng(20)
    exact, power = contact(0.8, share), spectrum(0.8)
    means, inside, counts, births = [], [], [], []
    for pair in range(12):
        a, b = surface(power, rng), surface(power, rng)
        areas = areas_at(a, b, exact.level, range(0, N, 8))
        means.append(areas.mean())
        inside.append(areas.var())
        counts.append(patch_counts(a, b, exact.level, range(0, N, 32)).mean())
        if pair < 4:
            births.append(slid(a, b, exact.level, N).births / N)
    scatter = lambda values: np.std(values, ddof=1) / sqrt(len(values))  # noqa: E731
    lags = np.array([exact.ensemble_covariance(s) for s in range(0, N, 8)])
    assert abs(np.mean(means) - exact.real_contact_area) < 4 * scatter(means)
    assert abs(np.mean(inside) - (lags[0] - lags.mean())) < 4 * scatter(inside)
    assert abs(np.mean(counts) - exact.junction_count) < 4 * scatter(counts) + 0.02 * exact.junction_count
    merged = 0.25 if share > 0.01 else 0.1  # at 3 % lives meet, and Euler's count of blobs is 20 % low
    assert abs(np.mean(births) - exact.birth_rate) < 4 * scatter(births) + merged * exact.birth_rate
    # A slider like its track, but with slopes twice as steep, is another contact: these bounds reject it.
    steeper = exact.junction_count * sqrt(2.5)
    assert abs(np.mean(counts) - steeper) > 4 * scatter(counts) + 0.02 * steeper


@pytest.mark.slow
def test_theory_knows_the_direction_of_a_ground_surface():
    """Waves three times as long across as along: births and number by brute force, and the turned pair is rejected."""
    rng, power = np.random.default_rng(8), spectrum(0.8, across=3.0)
    waves = Waves(power, (1.0, 1.0))
    exact = GaussianContact(waves, waves, 0.003, float(N * N), 1e9)
    turned = Waves(power.T.copy(), (1.0, 1.0))
    other = GaussianContact(turned, turned, 0.003, float(N * N), 1e9)
    births = [slid(surface(power, rng), surface(power, rng), exact.level, N).births / N for _ in range(6)]
    error = np.std(births, ddof=1) / sqrt(6)
    assert abs(np.mean(births) - exact.birth_rate) < 4 * error + 0.1 * exact.birth_rate
    assert abs(np.mean(births) - other.birth_rate) > 4 * error + 0.1 * other.birth_rate


@pytest.mark.slow
def test_forms_are_removed():
    x, y = np.meshgrid(np.arange(80) * 0.5, np.arange(120) * 0.4, indexing="ij")
    rough = 0.01 * np.random.default_rng(2).normal(size=x.shape)
    shapes = {
        "tilt": 3.0 + 0.02 * x - 0.05 * y,
        "polynomial": 0.001 * x * x - 0.002 * x * y + 0.01 * y,
        "sphere": np.sqrt(300.0**2 - (x - 22) ** 2 - (y - 18) ** 2),
        "cylinder": np.sqrt(200.0**2 - ((x - 15) * 0.8 + (y - 20) * 0.6) ** 2) + 0.01 * (0.8 * y - 0.6 * x),
    }
    for form, shape in shapes.items():
        made = HeightMap(heights=shape + rough, spacing=(0.5, 0.4))
        assert np.std(without_form(made, form).heights) == pytest.approx(0.01, rel=0.03), form
    assert np.std(without_form(HeightMap(heights=shapes["sphere"] + rough, spacing=(0.5, 0.4)), "tilt").heights) > 0.05


def test_patches_by_hand():
    heights = np.zeros((20, 20))
    heights[2:5, 2:5] = heights[5, 5] = heights[10, 10:14] = 1.0  # a square with a point at its corner, and a bar
    found = patches(heights + 1e-9 * np.arange(400).reshape(20, 20), 14 / 400, (0.5, 2.0))
    assert found.patch_count == 2
    assert found.areas.tolist() == [10.0, 4.0]
    assert found.largest_share == pytest.approx(10 / 14)


def test_synthetic_surfaces_are_what_was_asked_for():
    asked = {"points": 256, "spacing": 0.5, "roughness": 0.3, "hurst": 0.7, "rolloff": 32.0, "cutoff": 4.0}
    made = self_affine(**asked, seed=4)
    assert np.array_equal(made.heights, self_affine(**asked, seed=4).heights)
    assert not np.array_equal(made.heights, self_affine(**asked, seed=5).heights)
    assert made.heights.std() == pytest.approx(0.3, rel=1e-12)
    waves = Waves.of(made)
    f = np.fft.fftfreq(256, 0.5)
    q = np.hypot(f[:, None], f[None, :])
    low, high = (waves.power[(q > a) & (q < 1.1 * a)].mean() for a in (0.05, 0.2))
    assert np.log(high / low) / np.log(4.0) == pytest.approx(-3.4, abs=0.25)
    with pytest.raises(rubnoise.Refused, match="cutoff="):
        self_affine(**{**asked, "cutoff": 0.9}, seed=1)


def synthetic(seed, **more):
    return rubnoise.Surface.synthesise(**{"points": 512, "rolloff": "64 um", "cutoff": "8 um", "seed": seed, **more})


@pytest.mark.slow
def test_the_scenario_has_the_area_and_the_number_of_the_surfaces():
    found = synthetic(1).slide(synthetic(2), cutoff="8 um", load="2 N", hardness="1 GPa")
    assert found.refused == ()
    scenario = rubnoise.build({**_keys(found.scenario_text(speed=1e4)), "format": 1})
    theory = rubnoise.exact(scenario)
    assert theory.area.mean == pytest.approx(2000.0, rel=1e-4)
    assert theory.count_mean == pytest.approx(found.gaussian.junction_count, rel=1e-4)
    assert theory.area.std / theory.area.mean == pytest.approx(sqrt(2 / found.gaussian.junction_count), rel=1e-3)
    assert found.in_scenario["relative_std"] == pytest.approx(sqrt(2 / found.gaussian.junction_count), rel=1e-3)
    width = sqrt(4 * 2000.0 / (pi * found.gaussian.junction_count))
    assert found.in_scenario["correlation_length"] == pytest.approx(1.37866 * width, rel=1e-4)
    assert scenario.diameter.spread.as_text() == "52.2723 %"
    assert all(digest in found.scenario_text() for digest in (found.scans[0].digest, found.scans[1].digest))


def _keys(text):
    import tomllib

    return tomllib.loads(text)


def test_the_gap_of_two_maps_under_a_load_is_that_of_first_order():
    """The maps slid at constant load by brute force judge the spectra, which are quieter than the scenario."""
    track, slider = (synthetic(seed, points=1024, rolloff="128 um", cutoff="16 um") for seed in (1, 2))
    found = track.slide(slider, cutoff="16 um", load="31 N", hardness="1 GPa")
    gaussian = found.gaussian
    kept = round(found.share * track.heights.size)

    def gap(step):
        heights = heights_at(track.heights, slider.heights, step)
        return np.partition(heights, heights.size - kept, axis=None)[heights.size - kept]

    steps = np.arange(0, 1024, 8)
    before, after = (np.array([gap(step + more) for step in steps]) for more in (0, 1))
    slope = float(np.sqrt(np.square(after - before).mean()))
    # One pair of maps, 3 % in contact: second order takes a seventh, the maps' chance the rest.
    assert found.gap_slope == pytest.approx(slope, rel=0.16)
    assert gaussian.load_std == pytest.approx(before.std(), rel=0.25)
    fall = (areas_at(track.heights, slider.heights, before[0] - 0.01, [0]) / kept - 1.0) / 0.01
    assert gaussian.height_scale == pytest.approx(1.0 / float(fall[0]), rel=0.1)
    assert float(loads(found.scenario_text(speed=1e4, mass=1.0, damping_ratio=0.3)).load.height_scale) == pytest.approx(
        gaussian.height_scale, rel=1e-8
    )
    louder = 20.0 * log10(found.in_scenario["separation_slope"] / found.gap_slope)
    assert louder > 2.0
    assert any(f"{louder:+.1f} dB" in remark for remark in found.remarks)


@pytest.mark.parametrize(("speed", "ratio"), [(1e3, 0.05), (3e4, 0.3), (1e6, 1.0), (3e6, 0.05), (1e6, 2.0)])
def test_the_filter_of_the_load_is_that_of_the_theory_of_scenarios(speed, ratio):
    found = synthetic(1).slide(synthetic(2), cutoff="8 um", load="2 N", hardness="1 GPa")
    model = loads(found.scenario_text(speed=speed, mass=0.2, damping_ratio=ratio)).model()
    size, height = overlap_scale(model), found.gaussian.height_scale
    lags = np.linspace(0.0, 12.0, 6001)
    # Of parabolas with Rayleigh sizes, over the mean area: -R" = 2 (erfc(t/2) - t exp(-t^2/4)/sqrt(pi))/(N c^2).
    falling = erfc(0.5 * lags) - lags * np.exp(-0.25 * lags**2) / sqrt(pi)
    curve = 2.0 * falling / model.mean_junction_count / size**2
    resonance = sqrt(2e6 / (height * 0.2)) / speed
    assert speed * height * sqrt(filtered_variance(lags * size, curve, resonance, ratio)) == pytest.approx(
        load_motion(model).velocity_std, rel=1e-3
    )
    exact, ours = found.motions(speed=speed, mass=0.2, damping_ratio=ratio)
    assert ours.velocity_std == pytest.approx(load_motion(model).velocity_std, rel=1e-6)
    # Patches that gather on long waves begin and end less suddenly than parabolas.
    assert 0.5 < exact.velocity_std / ours.velocity_std < 1.0


def contact_of(*scans, cutoff):
    """A contact with 1 % of the slider's area in contact."""
    length, width = scans[1].size
    return SlidingContact(scans=scans, load=0.01 * length * width, hardness=1.0, cutoff=cutoff, slider_length=length)


def test_arrays_and_their_faults():
    heights = np.random.default_rng(0).normal(size=(40, 50))
    made = rubnoise.Surface.of(heights, spacing=("0.5 um", "200 nm"), unit="nm")
    assert made.map.size == pytest.approx((20.0, 10.0))
    assert made.heights.std() == pytest.approx(1e-3, rel=0.1)
    for bad, word in (
        (np.ones((3, 3)), "points"),
        (np.full((40, 40), np.nan), "no numbers"),
        (np.array(["x"]), "real numbers"),
    ):
        with pytest.raises(rubnoise.Refused, match=word):
            rubnoise.Surface.of(bad, spacing="1 um", unit="um")
    with pytest.raises(rubnoise.Refused, match="spacing="):
        rubnoise.Surface.of(heights)
    with pytest.raises(rubnoise.Refused, match="no waves"):
        contact_of(*2 * [HeightMap(heights=np.ones((64, 64)), spacing=(1.0, 1.0))], cutoff=4.0)


@pytest.mark.slow
def test_maps_of_different_grids_meet_on_the_sliders():
    whole = synthetic(3, cutoff="16 um").map
    coarse = HeightMap(heights=whole.heights[::2, ::2].copy(), spacing=(2.0, 2.0), name="coarse")
    fine = HeightMap(heights=whole.heights, spacing=(1.0, 1.0), name="fine")
    laid = coarse.on_grid_of(fine)
    assert laid.shape == (511, 511)
    assert np.abs(laid - fine.heights[:511, :511])[8:-8, 8:-8].max() < 0.01
    same, mixed = (contact_of(each, fine.turned(), cutoff=16.0) for each in (fine, coarse))
    assert mixed.gaussian.junction_count == pytest.approx(same.gaussian.junction_count, rel=0.02)
    assert mixed.gaussian.relative_std == pytest.approx(same.gaussian.relative_std, rel=0.05)
    assert mixed.counted.patch_count == pytest.approx(
        patches(coarse.on_grid_of(fine) + fine.turned().heights[:511, :511], 0.01, (1.0, 1.0)).patch_count, abs=4
    )


def test_roughness_is_that_of_the_standard():
    wave = np.sin(2 * pi * np.arange(100) / 20)[:, None] * np.ones((1, 60))
    found = rubnoise.Surface.of(wave, spacing="1 um", unit="um", form="none").roughness()
    assert found["Sq"] == pytest.approx(sqrt(0.5))
    assert found["Sa"] == pytest.approx(2 / pi, rel=0.01)
    assert found["Ssk"] == pytest.approx(0.0, abs=1e-12)
    assert found["Sku"] == pytest.approx(1.5)
    assert found["slope_along"] == pytest.approx(2 * pi / 20 * sqrt(0.5), rel=0.05)


class TestCommand:
    """`rubnoise surface`, where SurfaceTopography is installed."""

    @pytest.fixture(autouse=True)
    def library(self):
        pytest.importorskip("SurfaceTopography")

    @pytest.fixture
    def folder(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        for seed in (1, 2):
            synthetic(seed).save(tmp_path / f"{seed}.nc")
        return tmp_path

    def test_answer_scenario_and_report(self, folder):
        found = call(
            *("surface", "1.nc", "2.nc", "--cutoff", "8um", "--load", "2N", "--hardness", "1GPa", "--json"),
            *("-o", "s.toml", "--report", "s.html"),
        )
        assert found.code == 0
        answer = found.values()
        contact = synthetic(1).slide(synthetic(2), cutoff="8 um", load="2 N", hardness="1 GPa")
        assert answer["gaussian"]["junction_count"] == pytest.approx(contact.gaussian.junction_count, rel=1e-6)
        assert answer["counted"]["patch_count"] == contact.counted.patch_count
        assert found.json()["passed"]
        assert "data:audio/wav" in (folder / "s.html").read_text(encoding="utf-8")
        assert call("check", "s.toml").code == 0

    @pytest.mark.slow
    def test_levels_of_the_surfaces_stand_beside_those_of_the_scenario(self, folder):
        asked = ("surface", "1.nc", "2.nc", "--cutoff", "8um", "--load", "2N", "--hardness", "1GPa")
        moving = ("--speed", "30 mm/s", "--mass", "0.2 kg", "--damping-ratio", "0.3", "-o", "s.toml")
        answer = call(*asked, *moving, "--json").values()
        exact, ours = (answer[f"{name}_motion"]["velocity_level"] for name in ("gaussian", "scenario"))
        assert ours > exact + 1.0
        told = call(*asked, *moving, "--force").out
        assert f"warning: the scenario is {ours - exact:.1f} dB too loud" in told
        assert call(*asked, *moving, "--force", "--report", "heard.html").code == 0
        assert "at a sliding speed of 30 mm/s" in (folder / "heard.html").read_text(encoding="utf-8")
        theory = call("theory", "s.toml", "--json").values()
        assert theory["load"]["velocity_level"] == pytest.approx(ours, abs=1e-6)

    def test_without_a_cutoff_the_curve_is_shown(self, folder):
        found = call("surface", "1.nc", "--load", "2N", "--hardness", "1GPa")
        assert (found.code, found.out) == (2, "")
        assert "--cutoff" in found.err
        assert len(found.err.splitlines()) > 8

    def test_what_is_refused_writes_nothing(self, folder):
        for load in ("2mN", "30N"):
            found = call(*("surface", "1.nc", "--cutoff", "8um", "--load", load, "--hardness", "1GPa", "-o", "no.toml"))
            assert found.code == 2, load
            assert not (folder / "no.toml").exists()
            assert "internal error" not in found.err

    def test_synthetic_surface_keeps_its_bits_in_a_file(self, folder):
        asked = ("surface", "--synthesise", "--points", "512", "--rolloff", "64um", "--cutoff", "8um", "--seed", "1")
        assert call(*asked, "-o", "again.nc").code == 0
        read = rubnoise.Surface.read(folder / "again.nc")
        assert np.array_equal(read.heights, synthetic(1).heights)
        assert read.map.periodic
        assert np.array_equal(
            rubnoise.Surface.synthesise(points=64).heights, synthetic(1, points=64, rolloff=None, cutoff=None).heights
        )

    def test_a_synthetic_surface_needs_no_options(self, folder):
        assert call("surface", "--synthesise").code == 0
        asked = ("surface", "surface1.nc", "--cutoff", "5 um", "--load", "0.2 N", "--hardness", "1 GPa")
        assert call(*asked, "-o", "scenario.toml").code == 0
        assert sorted(each.name for each in folder.iterdir()) == ["1.nc", "2.nc", "scenario.toml", "surface1.nc"]

    def test_damaged_scans_are_refused(self, tmp_path):
        """Half a scan, its head alone, and twenty wrong bytes in its head: an answer, or one sentence."""
        rng, raw = np.random.default_rng(3), (SCANS / "plu-1.plu").read_bytes()
        wrong = bytearray(raw)
        for place in rng.integers(0, 3000, 20):
            wrong[place] = int(rng.integers(0, 256))
        for damaged in (raw[: len(raw) // 2], raw[:100], bytes(wrong)):
            (tmp_path / "damaged.plu").write_bytes(damaged)
            try:
                assert np.isfinite(rubnoise.Surface.read(tmp_path / "damaged.plu").heights).all()
            except rubnoise.Refused as refused:
                assert "damaged.plu" in str(refused)  # noqa: PT017  (either is right)

    def test_topographies_are_taken_as_they_are(self):
        from SurfaceTopography import Topography

        rng = np.random.default_rng(7)
        values = rng.normal(size=(40, 60))
        masked = np.ma.array(values, mask=rng.random(values.shape) < 0.02)
        made = rubnoise.Surface.of(Topography(masked, (20.0, 30.0), unit="nm"), form="none")
        assert made.map.spacing == pytest.approx((5e-4, 5e-4))
        assert made.heights[0, 0] == pytest.approx(values[0, 0] * 1e-3)
        assert "missing" in made.map.history[0]
        gone = np.ma.array(values, mask=np.ones(values.shape, dtype=bool))
        with pytest.raises(rubnoise.Refused, match="missing"):
            rubnoise.Surface.of(Topography(gone, (20.0, 30.0), unit="nm"))
        with pytest.raises(rubnoise.Refused, match="unit"):
            rubnoise.Surface.of(Topography(values, (20.0, 31.0)))

    @pytest.mark.filterwarnings("ignore:Function/property:DeprecationWarning")
    def test_roughness_agrees_with_the_library(self):
        from SurfaceTopography import Topography

        made = synthetic(1)
        topography = Topography(made.heights, made.map.size, unit="um", periodic=True)
        found = made.roughness()
        assert found["Sq"] == pytest.approx(topography.rms_height_from_area(), rel=1e-9)
        steep = sqrt(found["slope_along"] ** 2 + found["slope_across"] ** 2)
        assert steep == pytest.approx(topography.rms_gradient(), rel=0.05)


SCANS = Path(__file__).parents[2] / "notebooks" / "scans"
# Patches of a scan alone and pressed on itself turned by 180 degrees, at 1 % of the area, for Gaussian smoothing of so
# many points after a polynomial of second degree and waves longer than an eighth of the shorter side were removed.
COUNTED = [
    ("x3p-2.x3p", {0: (79, 98), 1: (55, 66), 2: (29, 42), 4: (17, 26), 8: (13, 18)}),
    ("plu-1.plu", {0: (1038, 1084), 1: (306, 308), 2: (50, 66), 4: (22, 24), 8: (7, 16)}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "rows"), COUNTED)
def test_patches_of_measured_scans(name, rows):
    pytest.importorskip("SurfaceTopography")
    scan = rubnoise.Surface.read(SCANS / name, form="polynomial").map
    rough = scan.heights - ndimage.gaussian_filter(scan.heights, min(scan.heights.shape) / 16)
    for points, (one, pair) in rows.items():
        smooth = ndimage.gaussian_filter(rough, points) if points else rough
        assert patches(smooth, 0.01, scan.spacing).patch_count == pytest.approx(one, rel=0.1, abs=2)
        assert patches(smooth + smooth[::-1, ::-1], 0.01, scan.spacing).patch_count == pytest.approx(
            pair, rel=0.1, abs=2
        )
