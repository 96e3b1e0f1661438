"""``coilcheck calibrate`` and ``compare --measured``: curves of a test bench, made by the model itself."""

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import equivbeam
import wirefe
from coilspring import (
    CoilSection,
    Contact,
    EquilibriumNotFound,
    Factors,
    InputError,
    Load,
    Material,
    Scene,
    Spring,
    Supports,
    benchfile,
    load_scene,
    scene_text,
    spring_a,
    spring_b,
)
from coilspring.benchfile import read_table
from coilspring.measured import Measured, measured
from coilspring.path import secants
from coilspring.scene.scene import load_directions
from equivbeam.curvefit import OFFSET
from equivbeam.sensitivity import NAMES
from validation.calibration import run
from validation.calibration.difference import along_load, difference, lines, scene_for, warnings
from validation.calibration.figure import finer, picture
from validation.calibration.slope import LABEL, slope
from validation.cli.arguments import EPILOG, FITTED
from validation.cli.command import main

GUIDED = Scene(
    "guided", Spring(2.0, 16.0, 8.0, 40.0), Load((0.0, -60.0), 20), supports=Supports(top_held=("ux", "rotz"))
)
NOISE = 0.02  # mm


@pytest.fixture(scope="module")
def bench():
    """Force and deflection of loading and unloading, of a spring that is 6 % stiffer, with noise."""
    found = equivbeam.solve(GUIDED, factors=(1.06, 1.0, 1.0), steps=400)
    deflection, force = along_load(found)
    forces = np.concatenate((np.linspace(0.5, 55.0, 60), np.linspace(54.0, 1.0, 40)))
    noise = np.random.default_rng(3).normal(scale=NOISE, size=forces.size)
    return forces, np.interp(forces, force, deflection) + noise


def write(file, curve, head="force,deflection", separator=",", decimal=".", signs=(1, 1), above=()):
    rows = [
        separator.join(f"{s * x:.5f}".replace(".", decimal) for s, x in zip(signs, row, strict=True))
        for row in zip(*curve, strict=True)
    ]
    file.write_text("\n".join((*above, head, *rows)) + "\n", encoding="latin-1")
    return file


def test_a_bench_curve_gives_back_what_was_put_in(bench, tmp_path, capsys):
    file = tmp_path / "guided.toml"
    file.write_text(scene_text(GUIDED))
    curve = write(tmp_path / "bench.csv", bench)
    out, names = tmp_path / "out", "axial,bending,shearing"
    assert main(["calibrate", str(file), str(curve), "--fit", names, "--out", str(out)]) == 0
    found = json.loads((out / "calibration.json").read_text())
    assert found["measured"] == str(curve)
    assert found["options"] == {"law": "haringx", "tangent": "exact", "sliding": "ignore"}
    axial = found["parameters"]["axial"]
    assert abs(axial["value"] - 1.06) < 3.0 * axial["standard_error"] < 3.0 * 0.002
    low, high = axial["interval"]
    assert low < 1.06 < high
    assert found["misfit"] is None
    assert found["residual"] == pytest.approx(NOISE / bench[1].max(), rel=0.2)
    for name in ("bending", "shearing"):
        assert found["parameters"][name]["standard_error"] is None
        assert found["parameters"][name]["value"] == 1.0
    assert found["rank"] == 1
    assert "bending 1, left at its start" in capsys.readouterr().out
    soft = replace(GUIDED, factors=Factors(axial=0.5))
    _, said = run.calibrate(soft, curve, ("axial",))
    assert "the scene as given is far from the curve, " in said[-1]
    calibrated = load_scene(out / "calibrated.toml")
    assert calibrated == replace(GUIDED, factors=Factors(axial=axial["value"]))
    assert (out / "calibration.png").read_bytes()[:4] == b"\x89PNG"


def test_a_curve_of_a_spreadsheet_in_utf_16_is_read(bench, tmp_path):
    curve = write(tmp_path / "bench.csv", bench)
    wide = tmp_path / "wide.csv"
    wide.write_text(curve.read_text(encoding="latin-1"), encoding="utf-16")
    one, other = read_table(curve).columns, read_table(wide).columns
    assert one.keys() == other.keys()
    assert all(np.array_equal(one[name], other[name]) for name in one)


def fit(curve, names, scene=GUIDED):
    return equivbeam.calibrate(scene, dict(zip(("force", "deflection"), curve, strict=True)), names)


def measured_of(scene):
    deflection, force = along_load(equivbeam.solve(scene, steps=200))
    return force[4:], deflection[4:]


@pytest.mark.parametrize("lag", [0.0, 0.5])
def test_standard_errors_hold_with_scatter_and_with_an_offset(lag):
    """Of 40 curves with known parameters 95 % or more have them in their intervals, which an offset that is
    not fitted widens; fitted, it is found."""
    deflection, force = along_load(equivbeam.solve(GUIDED, factors=(1.06, 1.0, 1.0), steps=200))
    forces = np.linspace(1.0, 59.0, 30)
    held = []
    for seed in range(40):
        noise = np.random.default_rng(seed).normal(scale=0.1, size=forces.size)
        curve = forces, np.interp(forces, force, deflection) + lag + noise
        alone, both = fit(curve, ["axial"]), fit(curve, ["axial", "offset"])
        assert ("fit offset too" in alone.misfit) == bool(lag)
        assert not both.misfit
        truths, found = [1.06, 1.06, lag], np.concatenate((alone.intervals, both.intervals))
        held.append([low <= truth <= high for truth, (low, high) in zip(truths, found, strict=True)])
    assert (np.mean(held, axis=0) >= 0.95).all()


@pytest.mark.parametrize("count", [1, 2])
def test_so_few_points_do_not_tell_how_well_the_model_fits(count):
    """Nothing is left to scatter, and an offset would take all of the error."""
    forces, deflection = (values[-count:] for values in measured_of(GUIDED))
    assert "fewer than 3 different points" in fit((forces, 1.001 * deflection), ["axial"]).misfit
    poor = fit((forces, 0.1 * deflection), ["axial"]).misfit
    assert "the model does not fit the curve" in poor
    assert "nan" not in poor
    assert "offset" not in poor


def test_an_exponent_of_one_has_an_error():
    """It is at the end of its range, which no step can pass, not at that of the search."""
    scene = replace(spring_b(), contact=replace(spring_b().contact, sliding="free", stiffness=2e3))
    force, deflection = measured_of(scene)
    noise = np.random.default_rng(0).normal(scale=NOISE, size=force.size)
    found = fit((force, deflection + noise), ["axial", "exponent", "offset"], scene)
    assert np.isfinite(found.errors).all()
    assert found.misfit == ""


def test_no_standard_error_at_the_edge_of_what_a_model_reaches():
    contact = replace(spring_b().contact, sliding="free", stiffness=400.0)
    scene = replace(spring_b(), contact=contact, load=Load((0.0, -179.0), 50))
    force, deflection = measured_of(scene)
    found = fit((force, 1.05 * deflection), ["penalty"], replace(scene, factors=Factors(axial=1.05)))
    assert np.isnan(found.errors).all()
    assert "the model does not fit the curve" in found.misfit
    assert "the path ends before the largest force" in found.misfit
    soft = replace(GUIDED, factors=Factors(axial=0.15))
    stiffer = fit(measured_of(GUIDED), ["axial"], soft)
    assert "0.2 or 5 times the start of axial" in stiffer.misfit


def test_what_was_fitted_is_said_with_units_and_without_exponents(tmp_path, capsys):
    """And written as it was given: the shear modulus, where the fit or the scene is of it."""
    curve = write(tmp_path / "bench.csv", measured_of(GUIDED))
    stiff = scene_text(GUIDED).replace("nu = 0.3 ", "G = 85000.0 ")
    (tmp_path / "stiff.toml").write_text(stiff)
    (tmp_path / "plain.toml").write_text(scene_text(GUIDED))

    def fitted(scene, names):
        run = ["calibrate", str(tmp_path / scene), str(curve), "--fit", names, "--out", str(tmp_path)]
        assert main(run) == 0
        found, material = (
            (tmp_path / "calibration.json").read_text(),
            (tmp_path / "calibrated.toml").read_text(),
        )
        return capsys.readouterr().out, json.loads(found)["parameters"], tomllib.loads(material)["material"]

    said, found, material = fitted("stiff.toml", "wire_diameter,offset")
    assert re.search(r"^wire_diameter [\d.]+ mm, standard error [\d.e-]+ mm, .* to [\d.]+ mm$", said, re.M)
    assert re.search(r"^offset [\d.e-]+ mm, standard error", said, re.M)
    assert [each["unit"] for each in found.values()] == ["mm", "mm"]
    assert (material["G"], "nu" in material) == (85000.0, False)
    said, found, material = fitted("plain.toml", "G,axial,penalty")
    assert re.search(r"^G [\d.]+ MPa, .*\naxial 1, .*\npenalty 10000 N/mm, ", said, re.M)
    assert [each["unit"] for each in found.values()] == ["MPa", None, "N/mm"]
    assert material["G"] == pytest.approx(found["G"]["value"], rel=1e-11)
    assert fitted("plain.toml", "axial")[2]["nu"] == 0.3


def test_large_shares_have_no_exponents():
    forces, deflection = measured_of(GUIDED)
    found = str(fit((forces, deflection / 20.0), ["pitch"]))
    assert re.search(r"does not fit the curve: \d{3,4} % of the peaks rms", found)


FORMATS = {
    "signs of path.csv": {"signs": (-1, -1)},
    "position falls": {"signs": (1, -1)},
    "semicolons, decimal commas": {"separator": ";", "decimal": ",", "head": "Load [N];Travel [mm]"},
    "tabs, a preamble": {"separator": "\t", "head": "F (N)\ts (mm)", "above": ("Prüfung 7", "Date\t1.2.26")},
    "a line of units": {"head": "Force,Deflection\nN,mm"},
    "Zwick": {"separator": ";", "decimal": ",", "head": "Standardkraft [N];Standardweg [mm]"},
    "Instron": {"head": "Load (N),Compressive extension (mm)"},
    "a displacement": {"head": "Force [N],Displacement [mm]"},
    "in": {"head": "Kraft in N,Weg in mm"},
    "underscores": {"head": "force_N,deflection_mm"},
    "bare units": {"head": "Standard force N,Travel mm"},
}


@pytest.mark.parametrize("name", FORMATS)
def test_formats_of_test_benches(name, bench, tmp_path):
    found = measured(write(tmp_path / "bench.csv", bench, **FORMATS[name]), GUIDED)
    np.testing.assert_allclose(found.force, bench[0], atol=1e-5)
    np.testing.assert_allclose(found.deflection, bench[1], atol=1e-5)


def test_other_columns_may_hold_anything(tmp_path):
    """A time of day was read as a number; a force without a deflection beside those of path.csv crashed."""
    curve = tmp_path / "bench.csv"
    curve.write_text("Time;Kraft [N];Weg [mm]\n12:30.5;1,5;0,5\n12:31.0;2,5;1,0\n")
    np.testing.assert_allclose(measured(curve, GUIDED).force, [1.5, 2.5])
    curve.write_text("time,load,load_y,uy\n0.5,x,-1,-2\n1,x,-2,-3\n")
    assert read_table(curve).columns.keys() == {"time", "load_y", "uy"}
    with pytest.raises(InputError, match="columns force and deflection, or load_y, uy; load_y is missing"):
        measured({"force": [1.0, 2.0]}, GUIDED)
    with pytest.raises(InputError, match=r"^row 2 must have a force in \[.*\] N, got 4e\+300 N$"):
        measured({"force": [1.0, 4e300], "deflection": [1.0, 2.0]}, GUIDED)


def test_no_force_before_and_after_the_curve_is_left_out():
    """Also where friction lets go of the spring later than it took it."""
    table = {
        "force": [0.0, 0.1, 50.0, 100.0, 50.0, 0.1, 0.0],
        "deflection": [0.0, 1.0, 5.0, 9.0, 6.0, 3.0, 0.0],
    }
    assert measured(table, GUIDED).left_out == 4


def test_units_and_points_without_load():
    found = measured({"force [kN]": [0.0, 0.01, 0.02], "deflection (m)": [0.0, 1e-3, 2e-3]}, GUIDED)
    np.testing.assert_allclose(found.force, [10.0, 20.0])
    np.testing.assert_allclose(found.deflection, [1.0, 2.0])
    assert found.left_out == 1
    for head in ({"Force [N]": [10.0], "Travel (CM)": [0.1]}, {"Force kN": [0.01], "Travel cm": [0.1]}):
        found = measured(head, GUIDED)
        np.testing.assert_allclose((found.force, found.deflection), ([10.0], [1.0]))


BAD = {
    "force,length\n1,2": "line 1 has no column deflection",
    "time,length\n1,2": "curve must have a line with the names",
    "Force lbf,Travel in\n1,2": "or Force [kN],Travel [cm], or those of path.csv, got 'Force lbf,Travel in'",
    "Force N,Force kN,Travel\n1,2,3": "one column force, got several",
    "": "curve must have a line with the names",
    "force,deflection\n": "at least one line of numbers",
    "force,deflection\n1,x": "line 2 must have a number in column 2, got 'x'",
    "force,deflection\n1,1_9": "line 2 must have a number in column 2, got '1_9'",
    "force,deflection\n1": "line 2 must have a number in column 2, got ''",
    "force,deflection\n1,5,2,5": "decimal commas the columns must be separated by semicolons",
    "force [lbf],deflection\n1,2": "column force must be in N or kN, got 'lbf'",
    "force,deflection (in)\n1,2": "column deflection must be in mm or cm or m or um or µm, got 'in'",
    "force,load,deflection\n1,2,3": "one column force, got several",
    "time,uy,uy\n1,2,3": "one column uy, got several",
    f"force,deflection\n1,{'2' * 200_000}": "bad.csv: field larger than field limit",
    "force,deflection\n1,nan": "bad.csv: line 2 must have a finite number in column 2, got 'nan'",
    "Time,Standardkraft [N]\n1,2": "bad.csv: line 1 has no column deflection (deflection, travel,",
    "Weg [mm],t\n1,2": "force, kraft, standardkraft, prüfkraft, federkraft), found 'Weg [mm], t'",
    "force,deflection\n1,9\n2,8": "deflection must grow with the force, got -1 mm/N on the whole: it counts",
    "force,deflection\n1,-1\n2,8": "deflection must not be negative, got -1 to 8 mm",
    "force,deflection\n1,9\n2,80": (
        "deflection must grow by at most spring.active_height = 28.6 mm, got 0 to 80 mm"
    ),
    "force,deflection\n1,0\n2,0": "not zero throughout, got 2 N and 0 mm at most",
    "time,load_x,load_y,ux,uy,rotz\n1,2,0,5,6,0": "not zero throughout, got 0 N and 6 mm at most",
    "deflection,force\n13,0\n9,90\n0.5,268.75\n0,279.5": "bad.csv: deflection must grow with the force",
    "force;deflection\n980.0;9.8\n1,050;10.5": (
        "bad.csv: numbers must have one decimal sign and no thousands separators, got '980.0' in line 2 and "
        "'1,050' in line 3"
    ),
    "force\tdeflection\n980,0\t9\n1.400\t10": "separators, got '980,0' in line 2 and '1.400' in line 3",
    "force;deflection\n1.050,5;9": "separators, got '1.050,5' in line 2",
    'force,deflection\n9.5,9\n"1,050",10': "separators, got '9.5' in line 2 and '1,050' in line 3",
    "force;deflection\n500;5\n980;9\n1,050;10\n1,400;14": (
        "bad.csv: line 4 must have a force of at least 49 N, since its deflection of 10 mm is above that of "
        "the largest force, 980 N, got 1.05 N: has it a thousands separator?"
    ),
    "force,deflection\n1,1\n4e300,2": "line 3 must have a force in [-1e+12, 1e+12] N, got 4e+300 N",
    "force [kN],deflection\n4e307,2": "line 2 must have a force in [-1e+12, 1e+12] N, got inf N",
    "force,deflection\n1,-4e300": "line 2 must have a deflection in [-1e+09, 1e+09] mm, got -4e+300 mm",
    "time,load_y,uy\n1,-4e300,-1": "line 2 must have a load_y in [-1e+12, 1e+12] N, got -4e+300 N",
}


def test_a_spring_cannot_be_compressed_by_more_than_its_height_wherever_deflection_counts_from():
    """Columns taken one for the other were fitted, with an offset of their size."""
    curve = {"force": [1.0, 2.0, 3.0], "deflection": [990.0, 1000.0, 1018.0]}
    assert measured(curve, GUIDED, from_rest=False).deflection[0] == 990.0
    curve["deflection"][0] = 970.0
    with pytest.raises(InputError, match=r"deflection must grow by at most .* = 40 mm, got 970 to 1018 mm"):
        measured(curve, GUIDED, from_rest=False)


def test_doubtful_curves():
    """Coils are solid, and the spring is another one: a warning each."""
    found = equivbeam.solve(GUIDED, steps=10)
    deflection, force = along_load(found)

    def warned(factor):
        curve = measured({"force": force, "deflection": factor * deflection}, GUIDED)
        return warnings({"equivbeam": found}, curve)

    assert warned(1.0) == []
    solid, other = warned(2.5)
    assert "is beyond solid: there are 24 mm" in solid
    assert "equivbeam and the measured curve differ by" in other


@pytest.mark.parametrize("command", ["calibrate", "compare"])
@pytest.mark.parametrize("text", BAD)
def test_bad_curves(text, command, tmp_path, capsys):
    file = tmp_path / "bad.csv"
    file.write_text(text)
    given = {"calibrate": [str(file), "--fit", "axial"], "compare": ["--measured", str(file)]}[command]
    assert main([command, "spring-b", *given, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert BAD[text] in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_command_knows_what_can_be_fitted():
    """It starts without the models, and so has names of its own."""
    assert sorted(FITTED) == sorted((*NAMES, OFFSET))


def test_bad_requests(tmp_path, capsys):
    curve = write(tmp_path / "bench.csv", ([1.0, 2.0], [1.0, 2.0]))
    for names, words in (
        ("axial,axial", "list of different names"),
        ("axial,", "--fit must be names with commas between, as axial,bending, got 'axial,'"),
        ("stiffness", "--fit must hold names of wire_diameter, mean_diameter,"),
        ("stiffness", "bending, offset, got 'stiffness'"),
        ("G,axial", "--fit may hold axial with the law haringx alone, got the law 'helix'"),
    ):
        call = ["calibrate", "spring-b", str(curve), "--fit", names, "--law", "helix"]
        assert main([*call, "--out", str(tmp_path / "x")]) == 2
        assert words in capsys.readouterr().err
    with pytest.raises(InputError, match=r"^parameters may hold axial with the law haringx alone"):
        equivbeam.calibrate(spring_b(), read_table(curve), ["G", "axial"], law="helix")
    stages = replace(GUIDED, load=Load(stages=((0.0, -4.0), (3.0, -4.0))), supports=Supports())
    with pytest.raises(InputError, match=r"in one direction where .*, got \[3.0, -4.0\] and \[0.0, -4.0\]$"):
        measured(read_table(curve), stages)
    with pytest.raises(InputError, match=r"^load.stages"):
        measured(curve, stages)  # the scene's mistake, not the file's
    equivbeam.solve(stages, steps=4).table.to_csv(tmp_path / "path.csv")  # which is fitted, but not drawn
    assert run.calibrate(stages, tmp_path / "path.csv", ("axial",))[0].keys().isdisjoint({"calibration.png"})


def test_a_calibration_keeps_the_files_it_has_read(tmp_path, capsys, monkeypatch):
    """They were overwritten without a word, in the folder of an earlier calibration, too."""
    monkeypatch.chdir(tmp_path)
    path = equivbeam.solve(replace(GUIDED, factors=Factors(axial=1.1)), steps=4)
    Path("calibrated.toml").write_text(scene := scene_text(GUIDED))
    said = []
    for number in (1, 2):
        curve = write(Path("measured.csv"), (-path.loads[:, 1], -number * path.tips[:, 1])).read_text()
        assert main(["calibrate", "calibrated.toml", "measured.csv", "--fit", "axial", "--out", "."]) == 0
        assert Path(f"measured.{number}.csv").read_text() == curve != Path("measured.csv").read_text()
        said.append(capsys.readouterr().out)
        assert f"measured.csv, which was read, is kept in measured.{number}.csv" in said[-1]
    assert Path("calibrated.1.toml").read_text() == scene
    assert main(["calibrate", "spring-b", "measured.1.csv", "--fit", "axial", "--out", "."]) == 0
    assert "is kept" not in capsys.readouterr().out  # a calibration takes the place of the one that was there


def test_a_force_that_the_spring_does_not_reach(tmp_path, capsys):
    curve = write(tmp_path / "bench.csv", ([1e4, 2e4], [5.0, 20.0]))
    assert main(["calibrate", "spring-b", str(curve), "--fit", "axial", "--out", str(tmp_path / "x")]) == 3
    assert (
        "of the curve of 2e+04 N, where the last coil closes at 549.6 N (are the units right?): limit point"
        in capsys.readouterr().err
    )
    assert not [file for file in (tmp_path / "x").rglob("*") if file.suffix in (".json", ".toml", ".png")]
    assert "what was reached is written by solve, compare, sweep, referee and view;" in EPILOG
    assert main(["calibrate", "spring-b", "none.csv", "--fit", "axial", "--out", str(tmp_path / "x")]) == 2
    assert "curve must be a readable CSV file, got 'none.csv'" in capsys.readouterr().err


def test_a_prescribed_displacement_is_fitted_through_its_reaction():
    """The same curve, pressed by a test machine: path.csv has the reaction."""
    pressed = replace(GUIDED, load=Load(displacement=(-12.0,), steps=10))
    curve = equivbeam.solve(pressed, factors=(1.06, 1.0, 1.0)).table
    found = equivbeam.calibrate(pressed, curve, ["axial"])
    assert found.values[0] == pytest.approx(1.06, rel=1e-4)
    assert found.scene.load == pressed.load


def test_compare_with_a_measured_curve(bench, tmp_path, capsys):
    file = tmp_path / "guided.toml"
    file.write_text(scene_text(replace(GUIDED.with_steps(8), factors=Factors(axial=1.06))))
    curve = write(tmp_path / "bench.csv", bench)
    mesh = ["--element", "curved", "--elements-per-turn", "8"]
    assert main(["compare", str(file), "--measured", str(curve), *mesh, "--out", str(tmp_path)]) == 0
    found = json.loads((tmp_path / "compare.json").read_text())["measured"]
    assert found["points"] == found["equivbeam"]["points"] == 100
    assert found["equivbeam"]["rms"] == pytest.approx(NOISE / bench[1].max(), rel=0.3)
    assert found["wirefe"]["max"] > 4.0 * found["equivbeam"]["max"]
    assert (tmp_path / "curve.png").exists()
    said = capsys.readouterr().out
    assert "equivbeam minus measured, deflection at the same force" in said
    assert "without the scene's [factors]" in said


def test_the_difference_is_counted_as_by_hand(bench):
    found = equivbeam.solve(GUIDED, steps=300)
    curve = measured({"force": bench[0] * 2.0, "deflection": bench[1]}, GUIDED)
    deflection, force = along_load(found)
    reached = curve.force <= 60.0
    by_hand = np.interp(curve.force[reached], force, deflection) - curve.deflection[reached]
    one = difference(found, curve)
    assert one["max"] == pytest.approx(np.abs(by_hand).max() / bench[1].max())
    assert (one["points"], one["beyond"]) == (np.count_nonzero(reached), np.count_nonzero(~reached))
    axes = picture({"equivbeam": found}, curve).axes
    assert [line.get_xdata().size for line in axes[0].get_lines()] == [80, 301]


def test_a_last_point_that_exceeds_the_load_in_its_last_digits_is_compared():
    """As after a conversion of units in ten digits: it was left out, the one that differed most."""
    found = equivbeam.solve(GUIDED, steps=300)
    deflection, force = along_load(found)
    rows = [100, 200, 300]
    for excess, points in ((1e-9, 3), (1e-5, 2)):
        sizes = force[rows] * [1.0, 1.0, 1.0 + excess]
        one = difference(
            found, measured({"force": sizes, "deflection": deflection[rows] + [0.0, 0.0, 0.1]}, GUIDED)
        )
        assert (one["points"], one["beyond"]) == (points, 3 - points)
        assert one["max"] == pytest.approx(0.1 / deflection[-1] if points == 3 else 0.0, rel=0.01, abs=1e-9)


@pytest.mark.parametrize(
    ("load", "equal"),
    [
        (Load((0.0, -200.0)), True),
        (Load((0.0, -200.0)), False),
        (Load(displacement=(-15.0,)), False),
        (Load(stages=((0.0, -50.0), (0.0, -20.0), (0.0, -200.0), (0.0, -1.0))), False),
    ],
    ids=["equal steps", "others", "pressed", "in stages"],
)
def test_a_model_does_not_differ_from_its_own_curve_in_few_steps(load, equal):
    """Straight lines between the steps of the scene were taken: 4.4 % off with two, and told as such."""
    scene = replace(spring_b(), load=replace(load, steps=2))
    fine = along_load(equivbeam.solve(replace(scene, load=load), steps=50 if equal else 997))
    further = np.flatnonzero(fine[1][1:] > np.maximum.accumulate(fine[1])[:-1]) + 1
    deflection, force = (values[further[:: 1 if equal else 90]] for values in fine)
    curve = measured({"force": force, "deflection": deflection}, scene)
    solved = scene_for(scene, curve)
    assert difference(equivbeam.solve(scene), curve)["max"] > 0.02
    assert difference(equivbeam.solve(solved), curve)["max"] < (1e-9 if equal else 1e-4)
    assert solved.load.steps == (50 if equal else 1000 if not load.stages else 900)
    assert solved.load.rows == solved.load.steps * (3 if load.stages else 1)  # unloading is not needed
    for steps in (solved.load.steps, 2 * solved.load.steps):
        enough = scene.with_steps(steps)
        assert scene_for(enough, curve) == enough


def test_of_several_stages_what_loads_further_than_before_is_compared():
    """With friction a force is met at another deflection on the way back."""
    load = Load(stages=((0.0, -150.0), (0.0, -100.0), (0.0, -200.0)), steps=300)
    scene = replace(spring_b(), load=load, contact=Contact(sliding="coulomb", friction=0.3))
    path = equivbeam.solve(scene, sliding="scene")
    deflection, force = along_load(path)
    first = np.append(np.arange(1, 301), np.flatnonzero(force > 150.5))
    curve = measured({"force": force[first], "deflection": deflection[first]}, scene)
    assert difference(path, curve)["max"] < 1e-12


def test_compare_solves_again_for_a_measured_curve(tmp_path, monkeypatch, capsys):
    """The rows of path.csv stay those of --steps."""
    curve = tmp_path / "bench.csv"
    equivbeam.solve(spring_b()).table.to_csv(curve)
    mesh = ["--element", "curved", "--elements-per-turn", "4", "--out", str(tmp_path)]
    assert main(["compare", "spring-b", "--measured", str(curve), "--steps", "2", *mesh]) == 0
    found = json.loads((tmp_path / "compare.json").read_text())["measured"]
    assert found["equivbeam"]["max"] < 1e-9
    assert 1e-3 < found["wirefe"]["max"] < 0.01
    for model in ("equivbeam", "wirefe"):
        assert len((tmp_path / model / "path.csv").read_text().splitlines()) == 3
    assert "equivbeam: completed, 2 of 2 steps" in capsys.readouterr().out


PRESSED = replace(GUIDED, load=Load((0.0, -300.0), 40))  # solid from 208 N on


@pytest.mark.parametrize("model", [equivbeam, wirefe])
def test_rates_are_drawn_from_rest_and_not_as_far_as_solid_coils(model):
    path = model.solve(PRESSED)
    rates = picture({path.model: path}, None).axes[1]
    (line,) = rates.get_lines()
    x, y = line.get_data()
    assert (x[0], line.get_marker(), rates.get_yscale()) == (0.0, "None", "linear")
    assert y[0] == pytest.approx(path.rates[0], rel=2e-3)
    assert 2.0 * y[0] < 2.0 * rates.get_ylim()[1] < y.max() / 10.0
    assert f"solid: rises to {float(f'{y.max():.3g}'):g} N/mm" in rates.texts[0].get_text()
    whole = picture({path.model: model.solve(GUIDED)}, None).axes[1]
    assert not whole.texts


PROGRESSIVE = Spring.of_sections(
    2.5, (CoilSection(2.5, (5.0, 7.0), (18.0, 25.0)), CoilSection(2.5, (7.0, 5.0), (25.0, 18.0)))
)


def test_a_progressive_spring_is_not_cut_and_not_called_solid():
    """Its rate, which grows fivefold as its coils close, ended at twice that at rest, with the word solid."""
    scene = replace(GUIDED, spring=PROGRESSIVE, load=Load((0.0, -160.0), 20))
    path = wirefe.solve(scene)
    axes = picture({"wirefe": path}, None).axes[1]
    assert not axes.texts
    assert path.rates.max() > 5.0 * path.rates[0]
    assert axes.get_ylim()[1] > path.rates.max()
    solid = wirefe.solve(replace(scene, load=Load((0.0, -300.0), 100)))
    axes = picture({"wirefe": solid}, None).axes[1]
    assert axes.texts[0].get_text().startswith("solid: rises to ")
    assert 30.0 < axes.get_ylim()[1] < 60.0


@pytest.mark.parametrize("steep", [50.0, 2000.0, np.nan])
def test_a_steep_rate_of_a_spring_that_is_not_solid_is_told_without_that_word(steep):
    path = equivbeam.solve(GUIDED)
    path.__dict__["rates"] = np.append(path.rates[:-1], steep) if steep > 0.0 else np.full(20, steep)
    path.shape.__dict__["rates"] = lambda *given: np.full(1, path.rates[0])
    axes = picture({"equivbeam": path}, None).axes[1]
    assert [each.get_text() for each in axes.texts] == ["rises to 2000 N/mm ↑"] * (steep == 2000.0)


def test_a_rate_that_hardly_varies_does_not_fill_the_axis():
    path = equivbeam.solve(replace(GUIDED, contact=Contact(enabled=False)))
    low, high = picture({"equivbeam": path}, None).axes[1].get_ylim()
    assert np.ptp(path.rates) < 0.05 * path.rates[0]
    assert low < 0.91 * path.rates.mean() < 1.09 * path.rates.mean() < high


@pytest.mark.parametrize("count", [4, 12, 100])
def test_the_measured_rate_is_that_of_the_curve(count):
    """Of a known one, 5 N/mm and from 6 mm on 1 N/mm more each mm, with scatter and another branch back."""
    x = np.linspace(0.0, 10.0, count)
    force = 5.0 * x + 0.5 * np.maximum(x - 6.0, 0.0) ** 2
    noise = np.random.default_rng(2).normal(scale=0.02, size=count)
    back = slice(-2, None, -3)
    cycle = Measured(np.append(force + noise, force[back] - 2.0), np.append(x, x[back]), 0)
    at, rates = slope(cycle)
    assert at.size == (count if count > 4 else 0)
    np.testing.assert_allclose(rates, 5.0 + np.maximum(at - 6.0, 0.0), atol=0.3)  # of the kink
    figure = picture({"equivbeam": equivbeam.solve(GUIDED)}, cycle)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert (LABEL in labels) == (count > 4)


def test_curves_are_drawn_from_the_finer_path():
    """Jumps of the rate were ramps of a step, where the comparison had been solved in a thousand."""
    scene = replace(GUIDED, spring=PROGRESSIVE, load=Load((0.0, -150.0), 20))
    coarse, fine = equivbeam.solve(scene), equivbeam.solve(scene, steps=500)
    curve = Measured(np.array([50.0, 150.0]), np.array([7.0, 18.5]), 0)
    for compared in (fine, coarse):
        axes = picture({"equivbeam": coarse}, curve, compared={"equivbeam": compared}).axes
        drawn = [each for each in axes if not each.get_ylabel().startswith("deflection")]
        assert [each.get_lines()[-1].get_xdata().size for each in drawn] == [len(compared.times) + 1] * 2
    shorter = equivbeam.solve(replace(scene, load=Load((0.0, -100.0), 500)))
    assert finer(coarse, shorter) is coarse


def test_rates_of_few_steps_are_marks():
    """Between them nothing is known; those of solid coils are seen on an axis of logarithms."""
    path = equivbeam.solve(PRESSED, steps=1)
    axes = picture({"equivbeam": path}, None).axes
    force, rate = (each.get_lines()[0] for each in axes)
    assert (force.get_marker(), rate.get_marker(), rate.get_linestyle()) == ("o", "o", "None")
    assert rate.get_xdata().size == 2
    assert axes[1].get_yscale() == "log"


def test_a_model_without_a_step_is_not_in_the_legend():
    path = equivbeam.solve(GUIDED)
    none = replace(path.select(slice(0)), model="wirefe")
    figure = picture({"equivbeam": path, "wirefe": none}, None)
    assert len(figure.axes[0].get_lines()) == len(figure.legends[0].get_texts()) == 1


STAGES = Load(stages=((0.0, -4.0), (-9.0, -4.0), (0.0, 0.0)), steps=40)
RATES = {
    "A": (spring_a(), equivbeam, {}),
    "A, wire": (spring_a(), wirefe, {"element": "curved", "elements_per_turn": 4}),
    "B, pressed": (replace(spring_b(), load=Load(displacement=(-12.0,))), equivbeam, {"sliding": "scene"}),
    "B, sticking wire": (spring_b(), wirefe, {"element": "curved", "elements_per_turn": 4}),
    "stages": (replace(spring_a(), load=STAGES), equivbeam, {}),
}


@pytest.mark.parametrize("case", RATES)
def test_rate_is_the_slope_of_the_curve(case):
    """The tangent's mean over a step against differences, where no pair closes or opens in it. In stages
    the first step of each turns the direction."""
    scene, model, options = RATES[case]
    path = model.solve(scene, **options)
    smooth = np.diff(path.active_contacts) == 0
    directions = load_directions(scene, path.times)
    smooth &= (np.diff(directions, axis=0) == 0.0).all(axis=1)
    mean, slope = 0.5 * (path.rates[1:] + path.rates[:-1]), secants(path, directions)[1:]
    np.testing.assert_allclose(mean[smooth], slope[smooth], rtol=5e-3)
    assert np.count_nonzero(smooth) > 30
    assert (path.table["rate"] == path.rates).all()


def test_rate_of_coulomb_friction_is_a_difference():
    rubbed = replace(spring_b(), contact=replace(spring_b().contact, sliding="coulomb", friction=0.2))
    path = equivbeam.solve(rubbed, sliding="scene", steps=10)
    rise = np.diff(-path.loads[:, 1], prepend=0.0) / np.diff(-path.tips[:, 1], prepend=0.0)
    np.testing.assert_allclose(path.rates, rise)


@pytest.mark.parametrize("names", [("axial", "G"), ("G", "axial")])
def test_of_two_that_a_curve_hardly_tells_apart_the_first_is_fitted(names):
    """Noise makes their derivatives differ; G also bends and shears the spring, a little."""
    scene = replace(GUIDED, spring=replace(GUIDED.spring, mean_diameter=(16.0, 14.0)))
    force, deflection = measured_of(scene)
    noise = np.random.default_rng(5).normal(scale=NOISE, size=force.size)
    found = fit((force, 0.93 * deflection + noise), list(names), scene)
    assert found.fixed == (names[1],)
    assert found.instead == ((names[0],),)
    assert f"the curve does not tell it from {names[0]}" in str(found)
    known = replace(found, undetermined=found.fixed, errors=np.array([0.01, np.nan]))
    assert f", with {names[1]} as given" in str(known).splitlines()[0]


SIDEWAYS = Load((-6.0, 0.0), 20)  # which bends the spring: there E counts beside G


def fit_of_moduli(names, material, E=203e3):
    """Of a curve of nu = 0.29."""
    scene = replace(GUIDED, load=SIDEWAYS, material=Material(193e3, 0.29), supports=Supports(("rotz",)))
    curve = measured_of(replace(scene, material=Material(E, 0.29)))
    return fit(curve, names, replace(scene, material=material))


BY_G = Material.from_moduli(193e3, 193e3 / 2.58)


def test_young_s_modulus_alone_keeps_poisson_s_ratio():
    """G was held throughout: a curve of the same nu gave 6 % more than its E, and nu 0.44."""
    for material in (Material(193e3, 0.29), BY_G):
        found = fit_of_moduli(["E"], material)
        assert found.values[0] == pytest.approx(203e3, rel=1e-6)
        assert found.scene.material.nu == material.nu
    for names in (["E", "G"], ["G", "E"]):
        found = fit_of_moduli(names, Material(193e3, 0.29))
        assert dict(zip(names, found.values, strict=True)) == pytest.approx(
            {"E": 203e3, "G": 203e3 / 2.58}, rel=1e-6
        )
    assert fit_of_moduli(["G"], Material(193e3, 0.29)).scene.material.E == 193e3


def test_poisson_s_ratio_is_told_where_a_fit_of_the_moduli_moves_it(tmp_path):
    scene = replace(GUIDED, material=Material(193e3, 0.29))
    curve = write(tmp_path / "bench.csv", measured_of(replace(scene, material=Material(203e3, 0.29))))
    files, said = run.calibrate(scene, curve, ("G",))
    assert "Poisson's ratio 0.29 -> 0.2265: it follows from E and G" in said
    files, said = run.calibrate(scene, curve, ("E",))
    assert not any("Poisson" in line for line in said)
    assert tomllib.loads(files["calibrated.toml"].decode())["material"]["nu"] == 0.29


def test_a_search_that_ends_at_a_bound_of_poisson_s_ratio_says_so():
    found = fit_of_moduli(["G"], BY_G, E=150e3)
    assert found.scene.material.nu == pytest.approx(0.5)
    assert np.isnan(found.errors).all()
    assert "the search ended at a bound of G, beyond which material.G must be a number in [64333.3, " in (
        found.misfit
    )
    assert found.misfit.endswith("which E = 193000 and Poisson's ratio allow")


def test_what_moves_no_curve_is_told_from_nothing():
    found = fit(measured_of(GUIDED), ["axial", "bending"], GUIDED)
    assert (found.fixed, found.instead) == (("bending",), ((),))


def test_a_file_of_the_outer_diameter_is_told_that_the_mean_one_is_held(bench, tmp_path, capsys):
    file, curve = tmp_path / "guided.toml", write(tmp_path / "bench.csv", bench)
    text = scene_text(GUIDED)
    for outer in (False, True):
        file.write_text(
            text.replace("mean_diameter = [16.0, 16.0]", "outer_diameter = 18.0") if outer else text
        )
        for name in ("wire_diameter", "axial"):
            call = ["calibrate", str(file), str(curve), "--fit", name, "--out", str(tmp_path / "out")]
            assert main(call) == 0
            told = "not the outer_diameter of the file" in capsys.readouterr().out
            assert told == (outer and name == "wire_diameter")


def test_a_wire_model_without_the_factors_of_a_law_is_no_doubt_of_the_curve():
    scene = replace(GUIDED, factors=Factors(axial=0.5))
    force, deflection = measured_of(scene)
    curve = measured({"force": force, "deflection": deflection}, scene)
    paths = {"wirefe": wirefe.solve(scene, element="curved", elements_per_turn=4, steps=5)}
    assert "it takes no [factors]" in warnings(paths, curve)[-1]
    assert not any("are the spring" in each for each in warnings(paths, curve))


def bench_with_a_gap(tmp_path, gap=3.0, noise=0.05):
    """A curve of the guided spring, which the bench touches after `gap` mm; noise is of its load cell."""
    deflection, force = along_load(equivbeam.solve(GUIDED, factors=(1.06, 1.0, 1.0), steps=60))
    random = np.random.default_rng(5).normal(scale=noise, size=100)
    forces = np.concatenate((np.zeros(40), force[1:])) + random
    return write(tmp_path / "bench.csv", (forces, np.append(np.linspace(0.0, gap, 40), gap + deflection[1:])))


def test_before_it_touches_a_bench_tells_nothing(tmp_path):
    """Half of the noise is above zero: it pulled the offset down by a tenth, and the stiffness by 2.5 %."""
    curve = bench_with_a_gap(tmp_path)
    found = equivbeam.calibrate(GUIDED, curve, ["axial", "offset"])
    assert measured(curve, GUIDED).left_out == 40
    assert found.values == pytest.approx([1.06, 3.0], rel=3e-3)
    assert found.misfit == ""


def test_a_fitted_offset_goes_into_figure_and_comparison(tmp_path, capsys, monkeypatch):
    """The picture had the points beside the curve that was fitted to them; `compare` has no offset."""
    drawn = []
    monkeypatch.setattr(
        "validation.calibration.figure.load_curves", lambda *given: drawn.append(given) or b""
    )
    (tmp_path / "guided.toml").write_text(scene_text(GUIDED))
    curve, out = bench_with_a_gap(tmp_path), tmp_path / "out"
    given = [str(tmp_path / "guided.toml"), str(curve), "--fit", "axial,offset", "--out", str(out)]
    assert main(["calibrate", *given]) == 0
    said = capsys.readouterr().out
    assert "40 points before the spring is loaded left out" in said
    assert "measured.csv and the figure are without the offset" in said
    (paths, points, _) = drawn[0]
    assert (
        difference(paths["calibrated"], points)["max"]
        < 5e-3
        < difference(paths["calibrated"], measured(curve, GUIDED))["max"]
    )
    calibrated = load_scene(out / "calibrated.toml")
    again = measured(out / "measured.csv", calibrated)
    np.testing.assert_allclose(again.deflection, points.deflection, rtol=1e-6)
    assert difference(equivbeam.solve(calibrated), again)["max"] < 5e-3


def test_a_curve_beyond_a_limit_point_is_told_how_much_of_it_can_be_kept(tmp_path, capsys):
    curve = write(tmp_path / "bench.csv", ([100.0, 700.0], [5.0, 20.0]))
    assert main(["calibrate", "spring-b", str(curve), "--fit", "axial", "--out", str(tmp_path / "x")]) == 3
    said = capsys.readouterr().err
    force = float(said.rsplit("leave out what is beyond ")[1].split(" N")[0])
    scene = replace(spring_b(), load=Load((0.0, -force)))
    assert equivbeam.solve(scene).outcome == "completed"
    with pytest.raises(EquilibriumNotFound):
        equivbeam.solve(replace(scene, load=Load((0.0, -1.001 * force))))


def test_a_curve_beyond_the_model_is_not_sent_to_another_one():
    """A fit is of the beam alone: which force to leave out is what helps."""
    scene = replace(GUIDED, spring=Spring(4.0, 25.0, 5.5, 39.6))
    with pytest.raises(EquilibriumNotFound) as found:
        equivbeam.calibrate(scene, {"force": [100.0, 5000.0], "deflection": [1.0, 18.0]}, ["axial"])
    message = found.value.message
    assert "the beam's force may be far off" in message
    assert "wirefe" not in message
    force = float(message.rsplit("; leave out what is beyond ")[1].split(" N")[0])
    assert equivbeam.solve(replace(scene, load=Load((0.0, -force)))).outcome == "completed"


def test_an_offset_to_be_fitted_may_be_anything():
    """Curves were refused, or called beyond solid, for a deflection that begins far from rest."""
    deflection, force = along_load(equivbeam.solve(GUIDED))
    for lag in (38.0, -5.0):
        curve = {"force": force[1:], "deflection": deflection[1:] + lag}
        found = equivbeam.calibrate(GUIDED, curve, ["axial", "offset"])
        assert found.values == pytest.approx([1.0, lag], rel=1e-6)
        with pytest.raises(InputError, match="deflection must"):
            equivbeam.calibrate(GUIDED, curve, ["axial"])
        at_rest = measured(curve, GUIDED, from_rest=False).from_rest(lag, GUIDED)
        np.testing.assert_allclose(at_rest.deflection, deflection[1:], atol=1e-9)
        assert at_rest.warnings == ()
    before = measured({"force": [1.0, 50.0, 60.0], "deflection": [0.0, 8.0, 10.0]}, GUIDED, from_rest=False)
    assert before.from_rest(1.0, GUIDED).left_out == 1


def test_displacements_at_times_are_fitted_as_they_are(tmp_path, capsys):
    """No points of force and deflection were fitted, and none left out; their load is the scene's."""
    scene = spring_a().with_steps(400)
    equivbeam.solve(scene).table.to_csv(tmp_path / "path.csv", index=False)
    out = tmp_path / "out"
    given = ["calibrate", "spring-a", str(tmp_path / "path.csv"), "--fit", "axial", "--out", str(out)]
    assert main(given) == 0
    assert "left out" not in capsys.readouterr().out
    assert sorted(file.name for file in out.iterdir()) == [
        "calibrated.toml",
        "calibration.json",
        "calibration.png",
    ]
    table = {"time": [0.05, 0.1], "uy": [-0.1, -0.2]}
    with pytest.raises(EquilibriumNotFound) as found:
        equivbeam.calibrate(replace(spring_b(), load=Load((0.0, -700.0))), table, ["axial"])
    assert "leave out" not in found.value.message


def test_a_curve_without_the_deflection_along_the_load_is_fitted_but_not_drawn(tmp_path):
    """It was fitted, and then refused."""
    table = equivbeam.solve(spring_a(), steps=10).table[["time", "rotz", "load_y"]]
    table.to_csv(tmp_path / "turns.csv", index=False)
    files, lines = run.calibrate(spring_a(), tmp_path / "turns.csv", ("axial",))
    assert set(files) == {"calibration.json", "calibrated.toml"}
    assert lines[-1].startswith("calibration.png is not drawn: ")


def test_a_curve_that_can_be_fitted_but_is_no_force_over_deflection_is_not_drawn(tmp_path):
    """Displacements at the scene's own load are fitted whatever they are; the refusal cost the fit."""
    scene = replace(spring_a().without_contact(), load=Load((0.0, -4.0), steps=10))
    table = equivbeam.solve(scene).table[["time", "load_x", "load_y", "ux", "uy", "rotz"]]
    table.loc[:2, "uy"] += 5.0 * table["uy"].abs().max()
    table.to_csv(tmp_path / "shifted.csv", index=False)
    files, lines = run.calibrate(scene, tmp_path / "shifted.csv", ("axial",))
    assert set(files) == {"calibration.json", "calibrated.toml"}
    assert f"calibration.png is not drawn: {tmp_path / 'shifted.csv'}" in lines[-1]


def test_what_a_comparison_leaves_out_is_said(bench):
    force, deflection = (np.append(0.1, column) for column in bench)
    path = equivbeam.solve(GUIDED)
    assert lines({"equivbeam": path}, measured({"force": force, "deflection": deflection}, GUIDED))[-1] == (
        "1 point before the spring is loaded left out"
    )
    one = lines({"equivbeam": path}, measured({"force": [50.0], "deflection": [10.0]}, GUIDED))
    assert one[0].endswith("rms, at 1 point")


def test_what_rounding_leaves_is_nothing_systematic():
    """A model's own curve leaves 5e-15 of the peaks, which varies slowly along the curve."""
    load = Load(stages=((0.0, -8.0), (0.0, -2.0), (0.0, -11.0)), steps=5)
    scene = Scene("many", Spring(1.0, 15.0, 20.0, 60.0), load, supports=Supports(("ux", "rotz")))
    found = equivbeam.calibrate(scene, equivbeam.solve(scene).table, ["wire_diameter"])
    assert 0.0 < found.rms_after < 1e-10
    assert found.misfit == ""


@pytest.mark.parametrize("count", [2, 3, 20])
def test_a_point_that_is_repeated_is_one(count):
    """It tells no standard error, nor how well the model fits."""
    forces, deflection = (values[-1:] for values in measured_of(GUIDED))
    found = fit((np.repeat(forces, count), 1.01 * np.repeat(deflection, count)), ["axial"])
    assert np.isnan(found.errors).all()
    assert "fewer than 3 different points" in found.misfit


def test_points_on_the_model_tell_no_standard_error(tmp_path):
    """Of three on a line an error of 0 was said, with an interval of one value."""
    curve = write(tmp_path / "line.csv", ([10.0, 20.0, 60.0], [1.0, 2.0, 6.0]))
    files, said = run.calibrate(replace(GUIDED, contact=Contact(enabled=False)), curve, ("axial",))
    assert said[0].endswith(
        "standard error unknown: the points lie on the model, so there is no scatter to take it from"
    )
    known = json.loads(files["calibration.json"])["parameters"]["axial"]
    assert (known["standard_error"], known["interval"]) == (None, None)


def test_a_systematic_error_is_not_in_the_intervals():
    """A curve that stiffens, of a spring that does not."""
    force, deflection = measured_of(GUIDED)
    noise = np.random.default_rng(4).normal(scale=NOISE / 4, size=force.size)
    found = fit((force, deflection * (1.0 - 0.02 * force / force.max()) + noise), ["axial"])
    assert "the error left is systematic" in found.misfit
    assert "can miss the true values" in found.misfit
    assert np.isfinite(found.errors).all()
    assert fit((force, deflection + noise), ["axial"]).misfit == ""


def test_hysteresis_is_no_scatter():
    """Of loading and unloading in one file neighbours along the force are of both; so it was taken for it."""
    force, deflection = measured_of(GUIDED)
    noise = np.random.default_rng(4).normal(scale=NOISE / 8, size=(2, force.size))
    up, down = deflection + noise[0], 1.02 * deflection + noise[1]
    loop = np.append(force, 0.99 * force[::-1]), np.append(up, down[::-1])
    found, alone = fit(loop, ["axial"]), fit((force, up), ["axial"])
    assert alone.misfit == ""
    assert found.scatter == pytest.approx(alone.scatter, rel=0.5)
    assert "the error left is systematic" in found.misfit
    assert "loading and unloading differ by" in found.misfit
    mixed = np.random.default_rng(5).permutation(force.size)
    assert fit((force[mixed], up[mixed]), ["axial"]).scatter == pytest.approx(alone.scatter, rel=1e-6)


@pytest.mark.parametrize(
    "order",
    [
        lambda n: np.arange(n)[::-1],
        lambda n: np.append(np.arange(n), np.arange(0.7 * n, n, dtype=int)[::-1]),
        lambda n: np.append(
            np.arange(0.3 * n, dtype=int), np.append(np.arange(0.3 * n, dtype=int)[::-1], range(n))
        ),
        lambda n: np.append(n - 1, range(n)),
    ],
    ids=["unloading alone", "not far back", "loaded a little before", "the largest first"],
)
def test_no_hysteresis_is_told_of_one_curve(order):
    """Which misses the model by an error that varies along it, whatever the order of its points."""
    force, deflection = measured_of(GUIDED)
    noise = np.random.default_rng(4).normal(scale=NOISE / 8, size=force.size)
    bent = deflection * (1.0 - 0.02 * force / force.max()) + noise
    at = order(force.size)
    misfit = fit((force[at], bent[at]), ["axial"]).misfit
    assert "the error left is systematic" in misfit
    assert "loading and unloading" not in misfit


def test_parameters_that_nearly_stand_for_each_other_are_named():
    """G and the wire's diameter differ by where coils close, and the offset from both."""
    scene = replace(GUIDED, spring=PROGRESSIVE, load=Load((0.0, -150.0), 20))
    force, deflection = measured_of(scene)
    noise = np.random.default_rng(4).normal(scale=NOISE / 4, size=force.size)
    found = fit((force, deflection + noise), ["G", "offset", "wire_diameter"], scene)
    ((one, other, correlation),) = found.alike
    assert (one, other) == ("G", "wire_diameter")
    assert -1.0 < correlation < -0.99
    assert "G and wire_diameter nearly stand for each other (correlation -0.99" in str(found)
    alone = fit((force, deflection + noise), ["wire_diameter", "offset"], scene)
    assert not alone.alike
    assert "stand for each other" not in str(alone)


def test_two_branches_at_the_same_forces_are_no_fit():
    """Their means lie on the model; the points do not."""
    forces, deflection = measured_of(GUIDED)
    found = fit((np.repeat(forces, 2), np.outer(deflection, (0.8, 1.2)).ravel()), ["axial"])
    assert found.rms_after > 0.05
    assert "the model does not fit the curve" in found.misfit


def test_rows_that_are_repeated_are_no_systematic_error(bench):
    once = fit(bench, ["axial"])
    often = fit(tuple(np.repeat(values, 5) for values in bench), ["axial"])
    assert once.misfit == often.misfit == ""
    assert often.scatter == pytest.approx(once.scatter, rel=1e-9)


def test_a_path_is_read_at_its_own_load():
    """At 40 N, in a scene of 60 N: taken for shares of these, the spring was half as stiff again."""
    cone = replace(spring_b(), load=Load((0.0, -40.0), steps=20))
    path, driven = (
        equivbeam.solve(each) for each in (cone, replace(cone, load=Load(displacement=(-2.0,), steps=20)))
    )
    other = replace(cone, load=Load((0.0, -60.0), steps=20))
    alone = {name: path.curve[name] for name in ("time", "load_y", "uy")}
    turned = alone | {"load_y": -alone["load_y"]}  # as a bench counts
    for curve in (path, driven, path.curve, alone, turned):
        found = equivbeam.calibrate(other, curve, ["axial"])
        assert found.values == pytest.approx([1.0], rel=1e-5)
    rounded = {name: np.round(column, 3) for name, column in equivbeam.solve(spring_a()).curve.items()}
    assert equivbeam.calibrate(spring_a(), rounded, ["axial"]).values == pytest.approx([1.0], rel=1e-2)


@pytest.mark.parametrize(
    ("text", "force"),
    [
        ("Time;Force [kN];Travel [mm]\n0.0;;\n0.1;0.05;6.0\n", None),
        ("Time;Force [kN];Travel [mm]\n0.1;0.05;6.0\n", [50.0]),
        ("Force [kN];Travel\n;mm\n0.05;6.0\n", [50.0]),
        ("force,deflection\n40,4\n80,9.776\n79.5,9.8\n0.1,9.79\n", [40.0, 80.0, 79.5]),
        ("force,deflection\n40,4,\n80,9.776, ,\n", [40.0, 80.0]),
        ("Force [N];Travel [um]\n25;244\n75;732\n100;977\n125;1,221\n", None),
    ],
    ids=["empty", "time", "units", "let go", "commas at the end", "thousands"],
)
def test_odd_rows_of_a_bench(text, force, tmp_path):
    """A row without numbers is none of units; as a bench lets go it may record more deflection."""
    (tmp_path / "bench.csv").write_text(text)
    if force is None:
        with pytest.raises(InputError, match=r"line 2 must have a number|thousands separator"):
            measured(tmp_path / "bench.csv", GUIDED)
    else:
        np.testing.assert_allclose(measured(tmp_path / "bench.csv", GUIDED).force, force)


def test_a_file_is_read_once(tmp_path, monkeypatch, capsys):
    """By all of ``calibrate``; what is found wrong later still has the file's name."""
    curve, scene, read = tmp_path / "bench.csv", tmp_path / "scene.toml", []
    curve.write_text("force,deflection\n40,4\n80,9.776\n")
    text = benchfile._text
    monkeypatch.setattr(benchfile, "_text", lambda file: read.append(file) or text(file))
    scene.write_text(scene_text(GUIDED))
    run = ["calibrate", str(scene), str(curve), "--fit", "G", "--out", str(tmp_path / "out")]
    assert main(run) == 0
    assert read == [curve]
    curve.write_text("force,deflection\n80,4\n40,9.776\n")
    table = read_table(curve)
    assert read_table(table) is table
    with pytest.raises(InputError, match=r"^\S+bench\.csv: deflection must grow with the force"):
        measured(table, GUIDED)


@pytest.mark.parametrize("column", [5.0, [[1.0, 2.0]], [1.0, 2.0, 3.0]])
def test_columns_of_a_table_have_one_length(column):
    with pytest.raises(InputError, match="all of one length"):
        measured({"force": column, "deflection": [1.0, 2.0]}, GUIDED)


@pytest.mark.parametrize("factor", [1.02, 2.0, 4.0])
def test_a_parameter_that_moves_the_curve_little_is_found(factor):
    """The gradient of the squares is small at the start already."""
    cone = spring_b()
    start = replace(cone, contact=replace(cone.contact, stiffness=cone.contact.stiffness / factor))
    found = equivbeam.calibrate(start, equivbeam.solve(cone), ["penalty"])
    assert found.values == pytest.approx([cone.contact.stiffness], rel=1e-5)
