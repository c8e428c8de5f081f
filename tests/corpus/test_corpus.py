"""Every stored hostile or odd file through the command line: answered or refused, soon, in one clear line."""

from __future__ import annotations

import csv
import io
import json
import tempfile
from pathlib import Path

import pytest

import kinetostat as ks
from corpus.measured import assert_clean, assert_one_line, kinetostat, unprintable
from corpus.watched import watch
from kinetostat_cli import main

HERE = Path(__file__).parent
FILES = HERE / "files"
MANIFEST = {entry["name"]: entry for entry in json.loads((HERE / "manifest.json").read_text(encoding="utf-8"))}

# Verdict ok or warn, and refused all the same.
REFUSED_THOUGH_USABLE = {
    # Every DOCTYPE is refused, for it can name other files and expand without end; no real file has one (design, 6).
    "dtd_external.urdf": "DOCTYPE",
}

# Verdict error, and answered all the same: the defect bears on no number of a query, or the reader does what all tools
# do, and says so in a remark. None: a part that the reader does not look at (visuals, safety controllers), for `check`.
ANSWERED_THOUGH_WRONG = {
    "lim_missing_rev.urdf": "no limit: its range, effort and velocity count as unlimited",
    "lim_missing_pris.urdf": "no limit: its range, effort and velocity count as unlimited",
    "lim_no_effort.urdf": "no effort",
    "lim_no_velocity.urdf": "no velocity",
    "lim_swapped.urdf": "lower 1 is above upper -1",
    "lim_neg_effort.urdf": "effort limit -5 is negative",
    "mass_zero.urdf": "inertia without mass",
    "mass_novalue.urdf": "no mass value: the link counts as massless",
    "mass_textnode.urdf": "no mass value: the link counts as massless",
    "inertia_missing.urdf": "no ixx, ixy, ixz, iyy, iyz, izz: the link counts as massless",
    "inertia_notpsd.urdf": "inertia is not positive",
    "mesh_traversal.urdf": "leads out of the package",
    "mesh_package_traversal.urdf": "package",
    "mesh_file_uri.urdf": "only package:// and relative names are followed",
    "mesh_absolute.urdf": "an absolute path",
    "mesh_empty.urdf": "there is no such file",
    "mesh_bomb_dae.urdf": "there is no such file",
    "mesh_devzero.urdf": "an absolute path",
    "mesh_scale_nan.urdf": "there is no such file",
    "mesh_noattr.urdf": None,
    "geom_empty.urdf": None,
    "geom_sphere_neg.urdf": None,
    "geom_sphere_nan.urdf": None,
    "safety_incomplete.urdf": None,
}

REFUSED = sorted(
    [name for name, entry in MANIFEST.items() if entry["expected"] == "error" and name not in ANSWERED_THOUGH_WRONG]
    + list(REFUSED_THOUGH_USABLE)
)
ANSWERED = sorted(set(MANIFEST) - set(REFUSED))

# What the reader says of files with verdict warn; those that are not here have an oddity that bears on no number.
REMARKS = {
    "robot_empty_name.urdf": "no name",
    "leading_blank_before_decl.urdf": "blank lines before the XML declaration",
    "latin1_declared.urdf": "encoded as ISO-8859-1",
    "axis_missing.urdf": "default 1 0 0",
    "axis_nonunit.urdf": "length 2",
    "axis_nonunit_prismatic.urdf": "length 2",
    "origin_two.urdf": "2 <origin> elements: the first, at line 5, counts",
    "two_inertials.urdf": "2 <inertial> elements: the first, at line 4, counts",
    "lim_only_lower.urdf": "no upper: URDF's default 0 holds",
    "lim_equal.urdf": "the joint cannot move",
    "lim_inf.urdf": "an infinite limit",
    "lim_deg.urdf": "are these degrees?",
    "floating.urdf": "floating",
    "floating_leaf.urdf": "floating",
    "fixed_only.urdf": "no joint can move",
    "mimic_mult0.urdf": "multiplier 0",
    "mimic_on_fixed.urdf": "no effect",
    "name_link_eq_other_joint.urdf": "a link has the same name",
    "name_fixed_joint_eq_link.urdf": "a link has the same name",
    "nm_spaces.urdf": "white space",
    "nm_newline.urdf": "white space or an unprintable character",
    "nm_leadtrail.urdf": "white space",
    "nm_frame_case.urdf": "upper and lower case",
    "mesh_package.urdf": "the package is not found",
    "mesh_windows.urdf": "an absolute path",
    "version_1.urdf": "not of the form 1.0",
    "version_1.1.urdf": "older than urdfdom 5",
}

# One file of each kind of ending, and those meant to hang or bloat, are also run as the real command.
AS_PROCESS = (
    "ok_base.urdf",
    "billion_laughs_attr.urdf",
    "bomb_malformed_fallback.urdf",
    "cycle_long.urdf",
    "cycle_reachable.urdf",
    "gz_named_urdf.urdf",
    "mesh_devzero.urdf",
    "mesh_traversal.urdf",
    "mimic_circular.urdf",
    "nm_10k.urdf",
    "nm_unicode.urdf",
    "utf16le_nobom.urdf",
    "xmlnest_600.urdf",
)


def questions(path: Path) -> list[list[str]]:
    """Return the command lines that are asked of a file: what is in it, and the Jacobian of its last link."""
    try:
        frame = ks.load(path).robot.links[-1].name
    except ks.RobotError:
        frame = "b"
    return [
        ["info", str(path), "-v"],
        ["jacobian", str(path), f"--frame={frame}"],
        ["jacobian", str(path), f"--frame={frame}", "-q", "mid"],
    ]


def test_the_manifest_lists_every_file():
    assert {path.name for path in FILES.iterdir()} == set(MANIFEST)
    assert set(REFUSED_THOUGH_USABLE) | set(ANSWERED_THOUGH_WRONG) | set(REMARKS) | set(AS_PROCESS) <= set(MANIFEST)


def test_the_verdicts_of_the_manifest_are_followed_but_for_the_exceptions():
    assert all(MANIFEST[name]["expected"] != "error" for name in REFUSED_THOUGH_USABLE)
    assert all(MANIFEST[name]["expected"] == "error" for name in ANSWERED_THOUGH_WRONG)


@pytest.mark.parametrize("name", ANSWERED)
@pytest.mark.parametrize("form", ["table", "json", "csv"])
def test_a_usable_file_is_answered(name, form, capsys):
    for question in questions(FILES / name):
        code = main.run([*question, "--format", form])
        out, err = capsys.readouterr()
        assert (code, "error" in err.split()) == (0, False), err
        assert "Traceback" not in out + err
        assert unprintable(err) == set()
        if form == "table":
            assert unprintable(out) == set()
        elif form == "json":
            assert json.loads(out)["crosscheck"]["agree"] is True
            assert "NaN" not in out
            assert unprintable(out) == set()
        else:
            rows = list(csv.reader(io.StringIO(out)))
            assert len({len(row) for row in rows}) == 1
            assert unprintable(out.replace("\r", "")) == set()


@pytest.mark.parametrize("name", REFUSED)
def test_an_unusable_file_is_refused_in_one_line_that_names_it(name, capsys):
    for question in questions(FILES / name):
        code = main.run(question)
        out, err = capsys.readouterr()
        assert code == 3
        assert_one_line(err, str(FILES / name))
        assert unprintable(err) == set()
        assert out == ""


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_is_the_same_for_every_way_of_asking(name):
    with pytest.raises(ks.RobotError) as first:
        ks.load(FILES / name)
    with pytest.raises(type(first.value)) as second:
        ks.load("-", stdin=io.BytesIO((FILES / name).read_bytes()))
    assert second.value.message == first.value.message
    assert second.value.line == first.value.line


@pytest.mark.parametrize(
    ("name", "remark"), [(n, r) for n, r in (ANSWERED_THOUGH_WRONG | REMARKS).items() if r is not None]
)
def test_what_is_odd_is_said(name, remark):
    said = [str(found) for found in ks.summary(ks.load(FILES / name)).remarks]
    assert any(remark in line for line in said), said


@pytest.mark.parametrize("name", [n for n, entry in MANIFEST.items() if entry["expected"] == "ok"])
def test_nothing_is_said_of_a_file_without_fault(name):
    assert ks.summary(ks.load(FILES / name)).remarks == ()


@pytest.mark.parametrize("name", AS_PROCESS)
def test_the_real_command_in_time_and_memory(name):
    for question in questions(FILES / name)[:2]:
        run = kinetostat(*question)
        assert_clean(run)
        assert run.exit_code == (3 if name in REFUSED else 0), run.err
        if name in REFUSED:
            assert_one_line(run.err, name)


@pytest.mark.parametrize(
    "name", ["ok_base.urdf", "nm_spaces.urdf", "nm_newline.urdf", "nm_unicode.urdf", "nm_10k.urdf"]
)
def test_text_fits_80_columns_whatever_the_names(name, capsys):
    for question in questions(FILES / name):
        main.run(question)
        assert max(map(len, capsys.readouterr().out.splitlines())) <= 80


def test_no_file_but_the_robots_own_is_opened_whatever_a_mesh_is_called():
    names = [name for name in ANSWERED if name.startswith("mesh_")]
    with watch() as opened:
        for name in names:
            ks.summary(ks.load(FILES / name))
    # What Pinocchio says is caught in a nameless file in the folder for temporary files.
    assert {path for path in opened if path.parent != Path(tempfile.gettempdir()) != path} == {
        FILES / name for name in names
    }
