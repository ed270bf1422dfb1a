"""Scenarios by path, name or object, and other values of their keys."""

import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest

import rubnoise
from rubnoise.api.sweep_result import short_names
from rubnoise.errors import ScenarioRefused, how_to_install, in_shell

UNIT: Any = pint.UnitRegistry()
BASE = rubnoise.example("paper/fig5")


def test_a_scenario_goes_by_path_name_or_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert rubnoise.load("paper/fig5").resolved() == rubnoise.load("paper/fig5.toml").resolved() == BASE.resolved()
    assert rubnoise.load(BASE) is BASE
    assert rubnoise.load(BASE, ["sliding.speed=2 mm/s"]).sliding.speed == 2000.0
    monkeypatch.chdir(tmp_path)
    Path("paper").mkdir()
    Path("paper/fig5").write_text(
        'format = 1\ntitle = "mine"\n[interface]\nmean_real_contact_area = "1 um^2"\n'
        'mean_junction_count = 2\n[sliding]\ndistance = "9 um"\n',
        encoding="utf-8",
    )
    assert rubnoise.load("paper/fig5").title == "mine"
    assert rubnoise.exact("paper/fig4").count_mean == pytest.approx(
        rubnoise.exact(rubnoise.example("paper/fig4")).count_mean
    )


def test_a_name_that_is_none_names_near_ones() -> None:
    with pytest.raises(rubnoise.Refused, match=r"neither a file nor a scenario.*did you mean paper/fig5"):
        rubnoise.load("paper/fig55")
    with pytest.raises(rubnoise.Refused, match="did you mean paper/fig5"):
        rubnoise.example("fig5")
    with pytest.raises(ScenarioRefused, match=r"nothing\.toml: cannot be read"):
        rubnoise.load("nothing.toml")
    assert {"paper/fig5", "lessons/poisson"} <= set(rubnoise.examples())


def test_one_key_is_replaced_and_all_else_stays() -> None:
    other = BASE.replace({"sliding.speed": "2 mm/s"}, seed=3)
    expected = BASE.resolved()
    expected["sliding"]["speed"], expected["run"]["seed"] = "2000 um/s", 3
    assert other.resolved() == expected
    assert other.replace({"sliding.speed": "1 mm/s"}, seed=1).resolved() == BASE.resolved()


def test_defaults_follow_what_is_replaced() -> None:
    bare = rubnoise.build(
        {
            "format": 1,
            "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
            "sliding": {"distance": 50.0},
        }
    )
    larger = bare.replace(mean_real_contact_area="800 um^2")
    assert float(larger.output.tick) == pytest.approx(2.0 * float(bare.output.tick))
    assert BASE.replace(damping_ratio=0.1).slider.damping is None
    two_way = BASE.replace(coupling="two-way")
    assert (two_way.slider.tolerance, two_way.replace(coupling="one-way").resolved()) == (1e-9, BASE.resolved())
    assert BASE.replace(slider=None).slider is None
    assert BASE.replace(slider={"mass": "6 g"}).slider.mass == 0.006
    assert BASE.replace(seed=8).replace(speed="0.5 mm/s").run.seed == 8


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"sped": 3}, "no key sped; did you mean speed?"),
        ({"spread": "1 um"}, '"diameter.spread" or "strength.spread"'),
        ({"sliding.speed": "2 mm"}, r"sliding\.speed: .mm. is the unit of a length"),
        ({"sliding.speed": 2.0}, r"sliding\.speed: a number without a unit\n +right form: .2\.0 um/s."),
        ({"speed": 2000}, r"sliding\.speed: a number without a unit"),
        ({"speed": np.float64(2000.0)}, r"sliding\.speed: a number without a unit"),
        ({"slider": {"mass": 0.005}}, r"slider\.mass: a number without a unit\n +right form: .0\.005 kg."),
        ({"slider.mass": 0.005, "run.seed": -1}, r"run\.seed(.|\n)*slider\.mass|slider\.mass(.|\n)*run\.seed"),
        ({"sliding.sped": 2.0}, "did you mean speed"),
        (
            {"sliding.speed": "-1 um/s", "run.seed": -1},
            r"run\.seed(.|\n)*sliding\.speed|sliding\.speed(.|\n)*run\.seed",
        ),
        ({"damping": 0.1, "damping_ratio": 0.1}, "both damping and damping_ratio"),
        ({"slider.mass": 3 * UNIT.um}, "is the unit of a length"),
    ],
)
def test_a_wrong_change_is_refused_like_a_wrong_file(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(ScenarioRefused, match=told):
        BASE.replace(changes)


def test_numbers_of_numpy_and_quantities_of_pint_go_where_they_fit() -> None:
    plain = BASE.replace({"sliding.speed": "2 mm/s", "slider.stiffness": "250 N/m", "mean_junction_count": 30})
    fancy = BASE.replace(
        {
            "sliding.speed": UNIT.Quantity(2, "mm/s"),
            "slider.stiffness": 250 * UNIT.N / UNIT.m,
            "mean_junction_count": np.int64(30),
        }
    )
    assert fancy.resolved() == plain.resolved()
    assert BASE.replace(mean_junction_count=UNIT.Quantity(30, "")).interface.mean_junction_count == 30
    assert BASE.replace(distance=UNIT.Quantity(0.1, "inch")).sliding.distance == 2540.0
    assert BASE.replace({"diameter.spread": 4 * UNIT.percent}).diameter.spread.as_text() == "4 %"
    record = rubnoise.simulate(BASE.replace(distance="100 um"), seed=np.int64(3))
    junction = record.junction(np.int32(9))
    place = junction.birth_distance + junction.diameter
    assert junction.area(UNIT.Quantity(place / 1000.0, "mm")) == pytest.approx(junction.area(place), rel=1e-9)
    with pytest.raises(ValueError, match="a quantity in um is needed"):
        junction.area(3 * UNIT.kg)


def test_short_names_are_those_that_mean_one_key() -> None:
    assert short_names(["a.x", "b.y"]) == {"a.x": "x", "b.y": "y"}
    assert short_names(["diameter.spread", "strength.spread", "sliding.speed"]) == {"sliding.speed": "speed"}
    assert short_names(["run.seed", "sliding.speed"], {"seed"}) == {"sliding.speed": "speed"}


def test_a_sweep_goes_by_its_name_and_its_keys_without_dots(tmp_path: Path) -> None:
    with rubnoise.run_sweep("paper/fig9", tmp_path / "s", jobs=1) as sweep:
        data = sweep.to_xarray()
        dotted = data["real_contact_area_std"].sel({"interface.mean_junction_count": 20.0})
        np.testing.assert_array_equal(data["real_contact_area_std"].sel(mean_junction_count=20.0), dotted)
        assert len(repr(sweep)) <= 1500
        assert "<table>" in sweep._repr_html_()
        assert sweep.plot("real_contact_area_std").axes


def test_messages_speak_python_and_in_a_shell_the_shells_words() -> None:
    assert in_shell("x.h5: exists already (force=True replaces it)") == "x.h5: exists already (--force replaces it)"
    assert in_shell("rubnoise.run(..., force=True) starts over") == "rubnoise run --force starts over"
    assert in_shell("jobs=: 0 is no number") == "--jobs: 0 is no number"
    assert in_shell("too little; jobs=3 fits") == "too little; --jobs 3 fits"


def test_advice_on_what_is_missing_works_where_it_is_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tool = shlex.split(how_to_install("plot"))[1]
    assert Path(tool).is_file()
    assert how_to_install("cluster").endswith("sync all")
    monkeypatch.chdir(tmp_path)
    there = Path(rubnoise.__file__).parents[2] / "tools" / "dev.py"
    assert Path(shlex.split(how_to_install("plot"))[1]).samefile(there)
    monkeypatch.setattr("rubnoise.errors.__file__", str(tmp_path / "lib" / "site-packages" / "rubnoise" / "errors.py"))
    assert how_to_install("plot") == 'python -m pip install "rubnoise[plot]"'
