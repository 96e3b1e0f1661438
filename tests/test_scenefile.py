"""Scene files: what they say equals what the dataclasses say, and what they may not say is refused."""

import math
import re
from dataclasses import fields, replace
from pathlib import Path

import pytest

import equivbeam
import wirefe
from coilspring import (
    CATALOGUE,
    CoilSection,
    Contact,
    InputError,
    Load,
    Material,
    Spring,
    load_scene,
    spring_b,
)
from coilspring.scene.scene import SECTIONS
from coilspring.scene.schema import keys_of, required
from coilspring.scene.toml import scene_from_text
from coilspring.scene.toml import scene_text as toml_text
from validation.cli import main

SPRING_B = {
    "": {"name": '"spring-b"'},
    "material": {"E": "206000.0", "nu": "0.3"},
    "spring": {
        "wire_diameter": "1.5",
        "mean_diameter": "[12.0, 6.0]",
        "active_coils": "7.5",
        "active_height": "28.6",
        "end_turns": "1.0",
        "start_phase": "0.0",
        "hand": '"left"',
    },
    "load": {"force": "[0.0, -200.0]", "steps": "50"},
    "supports": {"top_held": '["ux", "rotz"]'},
    "contact": {
        "enabled": "true",
        "stiffness": "1.0e4",
        "exponent": "1.0",
        "sliding": '"none"',
        "geometry": '"spheres"',
    },
}
SPRING_A = {
    "name": '"spring-a"',
    "spring.mean_diameter": "10.0",
    "spring.active_coils": "14.5",
    "load.force": "[-9.0, -4.0]",
    "supports.top_held": "[]",
    "contact.sliding": '"free"',
}


def scene_text(changes=None, without=()):
    """Spring B's file with values changed or added by ``section.key``, and keys or sections left out."""
    sections = {section: dict(keys) for section, keys in SPRING_B.items()}
    for where, value in (changes or {}).items():
        section, key = where.split(".", 1) if "." in where else ("", where)
        sections.setdefault(section, {})[key] = value
    for where in without:
        section, key = where.split(".", 1) if "." in where else ("", where)
        if where in sections:
            del sections[where]
        else:
            del sections[section][key]
    lines = []
    for section, keys in sections.items():
        lines += [f"[{section}]"] if section else []
        lines += [f"{key} = {value}" for key, value in keys.items()]
    return "\n".join(lines) + "\n"


OF_SECTIONS = """\
[spring]
wire_diameter = 1.5
end_turns = 1
[[spring.sections]]
coils = 2
pitch = [2.0, 3]
mean_diameter = [8, 10.0]
[[spring.sections]]
coils = 3.5
pitch = 3.0
mean_diameter = 10
[load]
force = [0, -10]
"""


def sections_text(*changes):
    """A file with sections, in which the first place of each old text is replaced by the new one."""
    text = OF_SECTIONS
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("spring-a", scene_text(SPRING_A)),
        (
            "spring-a-no-contact",
            scene_text(SPRING_A | {"name": '"spring-a-no-contact"', "contact.enabled": "false"}),
        ),
        ("spring-b", scene_text()),
        ("spring-b-no-contact", scene_text({"name": '"spring-b-no-contact"', "contact.enabled": "false"})),
    ],
)
def test_the_catalogue_as_files(name, text):
    assert scene_from_text(text) == load_scene(name) == CATALOGUE[name]()


def test_defaults_may_be_left_out():
    text = scene_text(
        SPRING_A, without=("name", "material", "supports", "contact", "load.steps", "spring.end_turns")
    )
    wires = replace(load_scene("spring-a"), contact=Contact())
    assert wires.contact.geometry == "wires"
    assert scene_from_text(text, "spring-a") == wires


def test_a_file_is_named_by_its_stem_unless_it_says_otherwise(tmp_path):
    file = tmp_path / "пружина.toml"
    file.write_bytes(b"\xef\xbb\xbf" + scene_text(without=("name",)).replace("\n", "\r\n").encode())
    assert load_scene(file).name == load_scene(str(file)).name == "пружина"


def test_sections_take_the_place_of_the_whole_springs_numbers():
    spring = scene_from_text(OF_SECTIONS).spring
    assert (spring.active_coils, spring.active_height, spring.mean_diameter) == (5.5, 15.5, (8.0, 10.0))
    assert spring.sections == (
        CoilSection(2.0, (2.0, 3.0), (8.0, 10.0)),
        CoilSection(3.5, (3.0, 3.0), (10.0, 10.0)),
    )
    assert {type(number) for section in spring.sections for number in (section.coils, *section.pitch)} == {
        float
    }
    assert replace(spring, hand="right").sections == spring.sections
    with pytest.raises(InputError, match=r"spring\.active_height must be 15\.5, as spring\.sections have it"):
        replace(spring, active_height=20.0)


def test_loads_of_several_stages():
    for text, load in (
        ("stages = [[0, -10], [1, 0]]", Load(stages=((0.0, -10.0), (1.0, 0.0)))),
        ("displacement = -10", Load(displacement=(-10.0,))),
        ("displacement = [-10, 0.5]\nsteps = 3", Load(displacement=(-10.0, 0.5), steps=3)),
    ):
        assert scene_from_text(sections_text(("force = [0, -10]", text))).load == load
    assert (load.rows, load.force, Load(stages=((0.0, -10.0), (1.0, 0.0))).force) == (6, (0, 0), (1, 0))


def test_two_moduli_say_the_same_as_poissons_ratio():
    G = 206_000.0 / 2.6
    scene = scene_from_text(scene_text({"material.G": repr(G)}, without=("material.nu",)))
    assert scene.material.nu == pytest.approx(0.3, rel=1e-14)
    assert pytest.approx(G, rel=1e-14) == scene.material.G
    only_G = scene_from_text(scene_text({"material.G": repr(G)}, without=("material.nu", "material.E")))
    assert only_G.material == scene.material


def test_friction_goes_with_coulomb():
    text = scene_text({"contact.sliding": '"coulomb"', "contact.friction": "1"})
    contact = scene_from_text(text).contact
    assert (contact.sliding, contact.friction, contact.coefficient) == ("coulomb", 1.0, 1.0)
    assert type(contact.friction) is float
    assert (load_scene("spring-a").contact.coefficient, load_scene("spring-b").contact.coefficient) == (
        0,
        math.inf,
    )


@pytest.mark.parametrize("record", SECTIONS.values())
def test_comments_say_the_defaults(record):
    words = {"none": (), "all three": ("ux", "uy", "rotz"), "true": True}
    for item in fields(record):
        key = keys_of(record)[item.name]
        said = re.search(r"\[(.*)\]|$", key.comment).group(1)
        if said is None:
            assert key.item or key.instead or key.absent == "" or item.name in required(record)
        else:
            number = isinstance(item.default, float | int) and said not in words
            assert item.default == (float(said) if number else words.get(said, said))


def test_the_largest_and_least_shear_modulus_are_allowed():
    assert Material.from_moduli(1000.0, 1000.0 / 3.0).nu == pytest.approx(0.5)
    assert Material.from_moduli(1000.0, 499_999.0).nu == pytest.approx(-0.999, abs=1e-8)


@pytest.mark.parametrize("text", ["10.0", "10", "[10.0, 10.0]", "[10, 10.0]"])
def test_one_mean_diameter_stands_for_both(text):
    assert scene_from_text(scene_text({"spring.mean_diameter": text})).spring.mean_diameter == (10.0, 10.0)


def test_integers_are_numbers_and_are_kept_as_floats():
    scene = scene_from_text(
        scene_text(
            {
                "material.E": "206000",
                "spring.wire_diameter": "1",
                "spring.active_coils": "7",
                "spring.active_height": "28",
                "spring.end_turns": "1",
                "spring.start_phase": "0",
                "load.force": "[0, -20]",
                "contact.stiffness": "10000",
                "contact.exponent": "1",
            }
        )
    )
    spring, contact = scene.spring, scene.contact
    numbers = [
        scene.material.E,
        *(spring.wire_diameter, spring.active_coils, spring.active_height, spring.end_turns),
        *(spring.start_phase, *spring.mean_diameter, *scene.load.force),
        *(contact.stiffness, contact.exponent),
    ]
    assert numbers == [206e3, 1.0, 7.0, 28.0, 1.0, 0.0, 12.0, 6.0, 0.0, -20.0, 1e4, 1.0]
    assert {type(number) for number in numbers} == {float}
    assert equivbeam.solve(scene, steps=1).outcome == "completed"


def test_a_right_handed_spring_is_the_mirror_image():
    left, right = (
        scene_from_text(scene_text({"spring.hand": f'"{hand}"'})).spring for hand in ("left", "right")
    )
    phases = [0.0, 1.0, 7.0]
    assert right.points(phases) == pytest.approx(left.points(phases) * [1.0, 1.0, -1.0])


def test_coils_of_a_cone_may_nest_where_no_end_turn_is_in_the_way():
    cone = {
        "spring.mean_diameter": "[40.0, 10.0]",
        "spring.active_height": "6.0",
        "spring.active_coils": "7.5",
    }
    assert scene_from_text(scene_text(cone | {"spring.end_turns": "0"})).spring.pitch == 0.8
    with pytest.raises(InputError, match=r"spring\.active_height must be .*\[11\.25, 1e\+09\].* got 6\.0"):
        scene_from_text(scene_text(cone))


def test_closed_coils_touch_without_overlap():
    assert Spring(wire_diameter=1.5, mean_diameter=(10.0, 10.0), active_coils=7.5, active_height=11.25)


HUGE = "1" + "0" * 400
HUGER = "0x" + "f" * 5000  # more digits than Python likes to show
# what is changed -> the field, a part of the range and a part of the value that the message must hold
REFUSED_VALUES = [
    ({"spring.wire_diameter": "-1.5"}, "spring.wire_diameter", "[1e-06, 1e+06]", "-1.5"),
    ({"spring.wire_diameter": "0"}, "spring.wire_diameter", "[1e-06, 1e+06]", "0"),
    ({"spring.wire_diameter": "nan"}, "spring.wire_diameter", "[1e-06, 1e+06]", "nan"),
    ({"spring.wire_diameter": "inf"}, "spring.wire_diameter", "[1e-06, 1e+06]", "inf"),
    ({"spring.wire_diameter": "1e400"}, "spring.wire_diameter", "[1e-06, 1e+06]", "inf"),
    ({"spring.wire_diameter": HUGE}, "spring.wire_diameter", "[1e-06, 1e+06]", "1000"),
    ({"spring.wire_diameter": HUGER}, "spring.wire_diameter", "[1e-06, 1e+06]", "int"),
    ({"spring.wire_diameter": '"1.5"'}, "spring.wire_diameter", "number", "'1.5'"),
    ({"spring.wire_diameter": "true"}, "spring.wire_diameter", "number", "True"),
    ({"spring.wire_diameter": "[1.5]"}, "spring.wire_diameter", "number", "[1.5]"),
    ({"spring.wire_diameter": "{ value = 1.5 }"}, "spring.wire_diameter", "number", "{'value': 1.5}"),
    ({"spring.wire_diameter": "1979-05-27"}, "spring.wire_diameter", "number", "datetime.date"),
    ({"spring.mean_diameter": "[12.0, 2.9]"}, "spring.mean_diameter", "[3, 1e+09]", "2.9"),
    ({"spring.mean_diameter": "-10.0"}, "spring.mean_diameter", "[3, 1e+09]", "-10.0"),
    ({"spring.mean_diameter": "[12.0]"}, "spring.mean_diameter", "one number or two", "[12.0]"),
    ({"spring.mean_diameter": "[]"}, "spring.mean_diameter", "one number or two", "[]"),
    ({"spring.mean_diameter": "[1.0, 2.0, 3.0]"}, "spring.mean_diameter", "one number or two", "3.0"),
    ({"spring.mean_diameter": '["a", 6.0]'}, "spring.mean_diameter", "number", "'a'"),
    ({"spring.mean_diameter": "[nan, 6.0]"}, "spring.mean_diameter", "[3, 1e+09]", "nan"),
    ({"spring.active_coils": "0.0"}, "spring.active_coils", "[0.5, 1000]", "0.0"),
    ({"spring.active_coils": "-7.5"}, "spring.active_coils", "[0.5, 1000]", "-7.5"),
    ({"spring.active_coils": HUGE}, "spring.active_coils", "[0.5, 1000]", "1000"),
    ({"spring.active_height": "11.0"}, "spring.active_height", "[11.25, 1e+09]", "11.0"),
    ({"spring.active_height": "-28.6"}, "spring.active_height", "[1e-06, 1e+09]", "-28.6"),
    ({"spring.end_turns": "0.25"}, "spring.end_turns", "0 or a number in [0.5, 100]", "0.25"),
    ({"spring.end_turns": "-1.0"}, "spring.end_turns", "[0, 100]", "-1.0"),
    ({"spring.start_phase": "-inf"}, "spring.start_phase", "[-1000, 1000]", "-inf"),
    ({"spring.hand": '"Right"'}, "spring.hand", "left, right", "'Right'"),
    ({"spring.hand": "1"}, "spring.hand", "left, right", "1"),
    ({"load.force": "[0.0, 0.0]"}, "load.force", "not both zero", "[0.0, 0.0]"),
    ({"load.force": "-200.0"}, "load.force", "two numbers", "-200.0"),
    ({"load.force": "[1.0, 2.0, 3.0]"}, "load.force", "two numbers", "3.0"),
    ({"load.force": "[0.0, nan]"}, "load.force", "[-1e+12, 1e+12]", "nan"),
    ({"load.force": '["0", -200.0]'}, "load.force", "number", "'0'"),
    ({"load.force": "[-1.0, 0.0]"}, "load.force", "direction that is free", "(-1.0, 0.0)"),
    ({"load.steps": "0"}, "load.steps", "[1, 100000]", "0"),
    ({"load.steps": "50.0"}, "load.steps", "integer in [1, 100000]", "50.0"),
    ({"load.steps": "true"}, "load.steps", "integer in [1, 100000]", "True"),
    ({"load.steps": HUGE}, "load.steps", "[1, 100000]", "1000"),
    ({"load.stages": "[[0, -1]]"}, "[load] takes one of", "force, stages, displacement", "force and stages"),
    ({"supports.top_held": '"ux"'}, "supports.top_held", "ux, uy, rotz", "'ux'"),
    ({"supports.top_held": '["uz"]'}, "supports.top_held", "ux, uy, rotz", "'uz'"),
    ({"supports.top_held": '["ux", "ux"]'}, "supports.top_held", "ux, uy, rotz at most once", "['ux', 'ux']"),
    ({"supports.top_held": "[[]]"}, "supports.top_held", "ux, uy, rotz", "[]"),
    ({"supports.top_held": '["ux", "uy"]'}, "load.force", "direction that is free", "['ux', 'uy']"),
    ({"supports.top_held": '["uy", "rotz"]'}, "load.force", "direction that is free", "(0.0, -200.0)"),
    ({"supports.bottom_held": "3"}, "supports.bottom_held", "ux, uy, rotz", "got 3"),
    ({"supports.seat": '"floor"'}, "supports.seat", "rigid, plate", "'floor'"),
    ({"spring.ends": '"unground"'}, "spring.ends", "one of closed, open, got 'unground'", ""),
    ({"spring.ends": '"ground"'}, "spring.ends", "closed, open", "'ground'"),
    ({"spring.ends": '"closed and ground"'}, "spring.ends", 'supports.seat = "plate"', "'closed and ground'"),
    (
        {"spring.free_length": "55.0"},
        "did you mean active_height, free length",
        "2 end_turns d if ground",
        "",
    ),
    ({"contact.enabled": "1"}, "contact.enabled", "true or false", "1"),
    ({"contact.enabled": '"yes"'}, "contact.enabled", "true or false", "'yes'"),
    ({"contact.stiffness": "0.0"}, "contact.stiffness", "[1e-09, 1e+12]", "0.0"),
    ({"contact.stiffness": "inf"}, "contact.stiffness", "[1e-09, 1e+12]", "inf"),
    ({"contact.exponent": "0.5"}, "contact.exponent", "[1, 5]", "0.5"),
    ({"contact.sliding": '"stick"'}, "contact.sliding", "free, none, coulomb", "'stick'"),
    ({"contact.sliding": '"coulomb"'}, "contact.friction", "is missing", '"coulomb" requires it'),
    ({"contact.friction": "0.3"}, "contact.friction", 'sliding = "coulomb" alone', "0.3 with 'none'"),
    ({"contact.sliding": '"coulomb"', "contact.friction": "0"}, "contact.friction", "[1e-06, 10]", "got 0"),
    ({"contact.sliding": '"coulomb"', "contact.friction": "11.0"}, "contact.friction", "10]", "11.0"),
    ({"contact.sliding": '"coulomb"', "contact.friction": "nan"}, "contact.friction", "10]", "nan"),
    ({"contact.sliding": '"coulomb"', "contact.friction": '"0.3"'}, "contact.friction", "number", "'0.3'"),
    ({"material.E": "-206000.0"}, "material.E", "[0.001, 1e+09]", "-206000.0"),
    ({"material.E": "2.06e11"}, "material.E", "206000000000.0; moduli are in MPa: 206e9 Pa are 206000", ""),
    ({"material.E": "206_000_000_000"}, "material.E", "got 206000000000; moduli are in MPa", ""),
    ({"material.nu": "0.6"}, "material.nu", "[-0.999, 0.5]", "0.6"),
    ({"material.nu": "-1.0"}, "material.nu", "[-0.999, 0.5]", "-1.0"),
    ({"material.G": "80000.0"}, "[material] takes one of", "nu, G", "got nu and G"),
    ({"name": "3"}, "name", "text", "3"),
    ({"name": '"  "'}, "name", "not empty", "'  '"),
    ({"spring.wire_diamter": "1.5"}, "'wire_diamter'", "did you mean wire_diameter?", "[spring]"),
    (
        {"spring.outer_diameter": "1.5"},
        "[spring] takes one of mean_diameter, outer_diameter, inner_diameter, sections",
        "got mean_diameter and outer_diameter",
        "",
    ),
    ({"spring.inside_diam": "1.5"}, "did you mean mean_diameter,", "or inner_diameter", "[spring]"),
    ({"spring.od": "1.5"}, "did you mean mean_diameter,", "or outer_diameter", "[spring]"),
    ({"spring.id": "1.5"}, "did you mean mean_diameter,", "or inner_diameter", "[spring]"),
    ({"spring.wire": "1.5"}, "did you mean wire_diameter? allowed", "", "[spring]"),
    ({"spring.pitch": "1.5"}, "did you mean active_height, the pitch times active_coils", "", "[spring]"),
    ({"spring.coil_diameter": "1.5"}, "did you mean mean_diameter? allowed", "", "[spring]"),
    ({"spring.Пружина": "1.5"}, "complete TOML", "line", ""),
    ({"spring.'Пружина'": "1.5"}, "'Пружина'", "wire_diameter", "[spring]"),
    ({"load.moment": "[0.0, 1.0]"}, "'moment'", "force, stages, displacement, steps", "[load]"),
    ({"colour": '"red"'}, "'colour'", "name, material, spring", "top level"),
    ({"friction.mu": "0.3"}, "'friction'", "name, material, spring", "top level"),
    ({"spring.wire_diameter" + ".a" * 3000: "1.5"}, "TOML", "", ""),
]
OF_PLAIN = ("spring.mean_diameter", "spring.active_coils", "spring.active_height")
REFUSED_TEXTS = [
    (scene_text(without=("spring.wire_diameter",)), "spring.wire_diameter is missing", "requires", ""),
    (
        scene_text(without=("load.force",)),
        "load.force is missing",
        "requires force, or stages, or displacement",
        "",
    ),
    (scene_text(without=("spring",)), "section [spring] is missing", "[load]", ""),
    (scene_text(without=("load",)), "section [load] is missing", "[spring]", ""),
    ("", "section [spring] is missing", "[load]", ""),
    ("\n\n# nothing\n", "section [spring] is missing", "[load]", ""),
    ("spring = 3\n" + scene_text(without=("spring",)), "spring", "a section [spring]", "3"),
    (scene_text().replace("[spring]", "[[spring]]"), "spring", "a section [spring]", "wire_diameter"),
    (scene_text(without=("material.nu",)) + "[material]\nG = 1.0\n", "TOML", "material", ""),
    (
        scene_text({"material.G": "60000.0"}, without=("material.nu",)),
        "material.G",
        "[68666.7, 1.03e+08]",
        "60000.0",
    ),
    (
        sections_text(("[spring]", "[spring]\nends = 'closed'\nends = 'open'")),
        "TOML",
        "'ends' in [spring]",
        "",
    ),
    (scene_text() + "name = 'a'\n[load]\n", "TOML", "'[load]' is given twice, the second time in line", ""),
    ("name = 'a'\nname = 'b'", "TOML", ": 'name' is given twice, the second time in line 2", ""),
    ("[load]\na = 1\r\na = [\n1,\n[2]]\n", "TOML", ": 'a' in [load] is given twice", "time in line 3"),
    ("[ load ]\na = 1\n[ load ]\n", "TOML", ": '[ load ]' is given twice, the second time in line 3", ""),
    ("'#' = 1\n'#' = 1", "TOML", "Cannot overwrite a value (at end of document)", ""),
    ("name = 1\nname.x = 2", "TOML", "Cannot overwrite a value (at end of document)", ""),
    ("[[a]]\nb.c = 1\n[[a]]\nb = 1\nb.c = 2", "TOML", "Cannot overwrite a value (at end of document)", ""),
    ("a = [\n['b'],\n['b']]\na = [\n['b'],\n['b']]\n", "TOML", ": 'a' is given twice", "time in line 4"),
    (scene_text().partition(", 6.0]")[0], "complete TOML", "Unclosed array", ""),
    (scene_text()[: scene_text().index("28.6") + 1], "section [load] is missing", "", ""),
    (scene_text().replace("28.6", "28.6.1"), "complete TOML", "line 9", ""),
    ("deep = " + "[" * 20_000 + "]" * 20_000, "complete TOML", "", ""),
    ("deep = " + "{ a = " * 20_000, "complete TOML", "", ""),
    ("spring." + "a." * 3000 + "a = 1\n", "'a'", "[spring]", "wire_diameter"),
    (
        scene_text({"spring.wire_diameter." + "a." * 3000 + "a": "1"}, without=("spring.wire_diameter",)),
        "spring.wire_diameter",
        "[1e-06, 1e+06]",
        "got ",  # too deep to be written out, or cut
    ),
    ("name = 9" + "9" * 5000, "complete TOML", "digits", ""),
    (sections_text(("force = [0, -10]", "displacement = -16")), "load.displacement", "above -15.5", "-16"),
    (sections_text(("force = [0, -10]", "stages = [[0, 1], 2]")), "load.stages[1]", "two numbers", "got 2"),
    (sections_text(("coils = 2", "coils = 0")), "spring.sections[0].coils", "[0.01, 1000]", "got 0"),
    (sections_text(("coils = 3.5", "coils = '3'")), "spring.sections[1].coils", "number in", "'3'"),
    (sections_text(("coils = 2", "coils = 999")), "sum of the coils", "[0.5, 1000]", "1002.5"),
    (sections_text(("pitch = 3.0", "pitch = 1.4")), "spring.sections[1].pitch", "[1.5, 1e+09]", "1.4"),
    (sections_text(("[2.0, 3]", "[2.0, nan]")), "spring.sections[0].pitch", "[1.5, 1e+09]", "nan"),
    (sections_text(("[2.0, 3]", "[2.0, 3, 4]")), "spring.sections[0].pitch", "one number or two", "[2.0, 3"),
    (sections_text(("[8, 10.0]", "[2, 10.0]")), "spring.sections[0].mean_diameter", "[3, 1e+09]", "got 2"),
    (sections_text(("[8, 10.0]", "[8, 9.0]")), "sections[1].mean_diameter", "begin with 9.0", "got 10.0"),
    (sections_text(("coils = 2\n", "")), "spring.sections[0].coils is missing", "requires coils", ""),
    (sections_text(("pitch", "pich")), "'pich'", "spring.sections[0]", "did you mean pitch?"),
    (
        sections_text(("[spring]", "[spring]\nactive_coils = 5.5")),
        "[spring] takes one of",
        "active_coils, sections",
        "got",
    ),
    (sections_text(("[spring]", "[spring]\npitch = 2")), "did you mean sections, each of which", "pitch", ""),
    (sections_text(("wire_diameter = 1.5", "")), "spring.wire_diameter is missing", "requires", ""),
    (scene_text({"spring.sections": "[]"}, without=OF_PLAIN), "spring.sections", "1 to 1000", "[]"),
    (scene_text({"spring.sections": "3"}, without=OF_PLAIN), "spring.sections", "tables", "got 3"),
    (scene_text({"spring.sections": "[3]"}, without=OF_PLAIN), "spring.sections[0]", "a table", "got 3"),
    (
        scene_text({"spring.sections": "{ coils = 3 }"}, without=OF_PLAIN),
        "spring.sections",
        "tables [[spring.sections]]",
        "{'coils': 3}",
    ),
]


def assert_refused(file, capsys, *parts):
    """Both Python and the command refuse the file in one line that holds `parts`."""
    with pytest.raises(InputError) as caught:
        load_scene(file)
    message = str(caught.value)
    assert [part for part in parts if part not in message] == [], message
    assert len(message.splitlines()) == 1
    assert len(message) < 400 + len(str(file))
    assert main(["solve", str(file), "--model", "equivbeam", "--out", str(file) + "-out"]) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err == f"coilcheck: {message}\n"


@pytest.mark.parametrize(
    ("changes", "field", "range_", "value"), REFUSED_VALUES, ids=lambda value: str(value)[:40]
)
def test_values_are_refused_by_field_range_and_value(changes, field, range_, value, tmp_path, capsys):
    file = tmp_path / "bad.toml"
    file.write_text(scene_text(changes), encoding="utf-8")
    assert_refused(file, capsys, field, range_, value, "bad.toml")


@pytest.mark.parametrize(
    ("text", "field", "range_", "value"), REFUSED_TEXTS, ids=lambda value: str(value)[:20]
)
def test_broken_files_are_refused(text, field, range_, value, tmp_path, capsys):
    file = tmp_path / "bad.toml"
    file.write_text(text, encoding="utf-8")
    assert_refused(file, capsys, field, range_, value, "bad.toml")


def test_what_is_no_text_file_is_refused(tmp_path, capsys):
    binary = tmp_path / "binary.toml"
    binary.write_bytes(bytes(range(256)))
    assert_refused(binary, capsys, "binary.toml", "UTF-8", "from byte 128 on")
    assert_refused(tmp_path, capsys, "SCENE", "directory", "spring-a")
    assert_refused(tmp_path / "missing.toml", capsys, "SCENE", "No such file", "spring-a")
    endless = tmp_path / "endless.toml"
    endless.symlink_to("/dev/zero")
    assert_refused(endless, capsys, "endless.toml", "at most 1000000 bytes", "more")


def test_the_equivalent_beam_takes_whole_half_coils(tmp_path, capsys):
    file = tmp_path / "quarter.toml"
    file.write_text(scene_text({"spring.active_coils": "7.25"}))
    assert load_scene(file).spring.active_coils == 7.25
    assert main(["solve", str(file), "--model", "equivbeam", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert f"{file}: spring.active_coils must be a multiple of 0.5" in error
    assert "got 7.25" in error


@pytest.mark.parametrize(
    ("key", "value", "model"),
    [
        *(
            ("bottom_held", value, model)
            for value in ('["ux", "uy"]', "[]")
            for model in ("equivbeam", "wirefe")
        ),
        ("seat", '"plate"', "equivbeam"),
    ],
)
def test_what_a_model_cannot_represent_is_said_plainly(key, value, model, tmp_path, capsys):
    file = tmp_path / "odd.toml"
    file.write_text(scene_text({f"supports.{key}": value}))
    load_scene(file)
    assert main(["solve", str(file), "--model", model, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(f"coilcheck: {file}: supports.{key} is unsupported by {model}")
    assert value.replace('"', "'") in error
    assert not (tmp_path / "out").exists()


def test_the_message_of_a_file_names_the_file():
    with pytest.raises(InputError, match=r"no-such-file\.toml"):
        load_scene(Path("no-such-file.toml"))
    with pytest.raises(InputError, match="SCENE must be the name of a scene or of a TOML file, got 3"):
        load_scene(3)


NAMED = {
    "solve": equivbeam.solve,
    "wire": wirefe.solve,
    "trace": wirefe.trace,
    "buckling": equivbeam.buckling,
    "stiffness": lambda name: equivbeam.lateral_stiffness(name, 1.0),
    "calibrate": lambda name: equivbeam.calibrate(name, "curve.csv", ["axial"]),
}


@pytest.mark.parametrize("value", ["spring-a", None], ids=str)
@pytest.mark.parametrize("function", NAMED)
def test_what_is_no_scene_is_refused_in_one_sentence(function, value):
    with pytest.raises(InputError, match="must be an? .*(Scene|Path).* got " + repr(value)) as caught:
        NAMED[function](value)
    assert "load_scene" in str(caught.value)


@pytest.mark.parametrize(("name", "wires"), [("outer_diameter", 1.0), ("inner_diameter", -1.0)])
def test_outer_or_inner_diameter_takes_the_place_of_the_mean_one(name, wires):
    mean = spring_b().spring.mean_diameter
    other = [value + wires * 1.5 for value in mean]
    text = scene_text({f"spring.{name}": repr(other)}, without=("spring.mean_diameter",))
    assert scene_from_text(text).spring == spring_b().spring
    one = Spring.of_diameter(1.5, **{name: 12.0 + wires * 1.5}, active_coils=7.5, active_height=28.6)
    assert one.mean_diameter == (12.0, 12.0)


def test_sections_take_outer_or_inner_diameters_too():
    spring = scene_from_text(sections_text()).spring
    outer = "mean_diameter = [8, 10.0]", "outer_diameter = [9.5, 11.5]"
    for given in ((outer,), (outer, ("mean_diameter = 10\n", "inner_diameter = 8.5\n"))):
        other = scene_from_text(sections_text(*given)).spring
        assert other == spring
        assert [each.mean_diameter for each in other.sections] == [(8.0, 10.0), (10.0, 10.0)]
        assert scene_from_text(toml_text(replace(spring_b(), spring=other))).spring == other


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            "inner_diameter = 1.0",
            r"spring\.sections\[1\]\.inner_diameter must be a finite number in \[1\.5, ",
        ),
        ("inner_diameter = 9.0\nouter_diameter = 9.0", "takes one of mean_diameter, outer_diameter, inner"),
        ("", r"spring\.sections\[1\]\.mean_diameter is missing"),
        ("od = 9.0", "did you mean mean_diameter, or outer_diameter in its place"),
        ("inner_diameter = 9.0", r"sections\[1\]\.mean_diameter must begin with 10\.0"),
    ],
)
def test_bad_diameters_of_sections(given, words):
    with pytest.raises(InputError, match=words):
        scene_from_text(sections_text(("mean_diameter = 10\n", given + "\n")))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"spring.outer_diameter": "9.0", "spring.inner_diameter": "6.0"},
            "got outer_diameter and inner_diameter",
        ),
        ({"spring.outer_diameter": "4.4"}, "spring.outer_diameter must be"),
        ({"spring.inner_diameter": "[3.0, 1.4]"}, "spring.inner_diameter must be"),
        ({"spring.outer_diameter": '"9"'}, "spring.outer_diameter must be"),
    ],
)
def test_bad_diameters(changes, words):
    with pytest.raises(InputError, match=words):
        scene_from_text(scene_text(changes, without=("spring.mean_diameter",)))


def test_a_spring_of_no_or_several_diameters():
    for given, words in (
        ({}, "got none"),
        ({"outer_diameter": 9.0, "mean_diameter": 8.0}, "must have one of mean_diameter"),
    ):
        with pytest.raises(InputError, match=words):
            Spring.of_diameter(1.5, **given, active_coils=7.5, active_height=28.6)
