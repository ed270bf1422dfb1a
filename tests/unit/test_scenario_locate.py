"""The locator finds every key and value of a TOML text."""

import pytest

from rubnoise.scenario.source import last_key, locate

TEXT = '''\
# a = 1
a = 1 # one
"b c".'d' = "x # y" # text
e.f . g = [1, 2, # three
  { h = "]" }, ]
i = { j = 'k', "l" = { m = 1.5 } }
n = """two
lines " "" """""
o = 1979-05-27 07:32:00   # a date
p = \'\'\'raw ' text\'\'\'

[ q . "r" ] # header
s = true
[[t]]
u = "\\u00b5\\""
[[t]]
u = 2
[t.v]
w = 3
[[t.x]]
[[t.x]]
y=4'''


def value(*path: str | int) -> str:
    span = locate(TEXT).values[path]
    return TEXT[span.start : span.end]


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (("a",), "1"),
        (("b c", "d"), '"x # y"'),
        (("e", "f", "g"), '[1, 2, # three\n  { h = "]" }, ]'),
        (("e", "f", "g", 1), "2"),
        (("e", "f", "g", 2, "h"), '"]"'),
        (("i",), "{ j = 'k', \"l\" = { m = 1.5 } }"),
        (("i", "l", "m"), "1.5"),
        (("n",), '"""two\nlines " "" """""'),
        (("o",), "1979-05-27 07:32:00"),
        (("p",), "'''raw ' text'''"),
        (("q", "r", "s"), "true"),
        (("t", 0, "u"), '"\\u00b5\\""'),
        (("t", 1, "u"), "2"),
        (("t", 1, "v", "w"), "3"),
        (("t", 1, "x", 1, "y"), "4"),
    ],
)
def test_a_value_is_where_it_is(path: tuple[str | int, ...], text: str) -> None:
    assert value(*path) == text


def test_a_key_is_where_it_is_first_named() -> None:
    keys = locate(TEXT).keys
    assert TEXT[keys["q", "r"].start : keys["q", "r"].end] == 'q . "r"'
    assert TEXT[keys["e", "f", "g"].start : keys["e", "f", "g"].end] == "e.f . g"
    assert TEXT[keys["e",].start : keys["e",].end] == "e"


@pytest.mark.parametrize("broken", ["a = 1\nb d = 2\nc = 3", "a = 1\n[b\nc = 3", "a = 1\n= 2", 'a = 1\n"\\q" = 2'])
def test_of_a_broken_text_the_sound_part_is_found(broken: str) -> None:
    spans = locate(broken)
    assert ("a",) in spans.values
    assert ("c",) not in spans.values


def test_the_last_key_named() -> None:
    assert last_key("[a]\nb.c = 1,5")[0] == ("a", "b", "c")
    assert last_key("[a]\nb = 1\n[d.e")[0] == ("d", "e")
    assert last_key("")[0] == ()


def test_deep_nesting_ends_in_time() -> None:
    assert locate("a = " + "[" * 60_000).keys.keys() == {("a",)}
