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
from kinetostat.lint.linting import oddities
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
    "lim_missing_rev.urdf": "J101",
    "lim_missing_pris.urdf": "J101",
    "lim_no_effort.urdf": "J106",
    "lim_no_velocity.urdf": "J106",
    "lim_swapped.urdf": "J103",
    "lim_neg_effort.urdf": "J108",
    "mass_zero.urdf": "I103",
    "mass_novalue.urdf": "I104",
    "mass_textnode.urdf": "I104",
    "inertia_missing.urdf": "I104",
    "inertia_notpsd.urdf": "I202",
    "mesh_traversal.urdf": "M103",
    "mesh_package_traversal.urdf": "M103",
    "mesh_file_uri.urdf": "M105",
    "mesh_absolute.urdf": "M104",
    "mesh_empty.urdf": "M101",
    "mesh_bomb_dae.urdf": "M101",
    "mesh_devzero.urdf": "M104",
    "mesh_scale_nan.urdf": "M101 X301",
    "mesh_noattr.urdf": "X206",
    "geom_empty.urdf": "X207",
    "geom_sphere_neg.urdf": "M204",
    "geom_sphere_nan.urdf": "X301",
    "safety_incomplete.urdf": "J401 J402",
}

REFUSED = sorted(
    [name for name, entry in MANIFEST.items() if entry["expected"] == "error" and name not in ANSWERED_THOUGH_WRONG]
    + list(REFUSED_THOUGH_USABLE)
)
ANSWERED = sorted(set(MANIFEST) - set(REFUSED))

# What the reader says of files with verdict warn; those that are not here have an oddity that bears on no number.
REMARKS = {
    "robot_empty_name.urdf": "X201",
    "leading_blank_before_decl.urdf": "X105",
    "latin1_declared.urdf": "X104",
    "axis_missing.urdf": "J203",
    "axis_nonunit.urdf": "J202",
    "axis_nonunit_prismatic.urdf": "J202",
    "origin_two.urdf": "X205",
    "two_inertials.urdf": "X205",
    "lim_only_lower.urdf": "J102",
    "lim_equal.urdf": "J104",
    "lim_inf.urdf": "J109",
    "lim_deg.urdf": "J110",
    "floating.urdf": "T111",
    "floating_leaf.urdf": "T111",
    "fixed_only.urdf": "T109",
    "mimic_mult0.urdf": "J305",
    "mimic_on_fixed.urdf": "J306",
    "name_link_eq_other_joint.urdf": "T112",
    "name_fixed_joint_eq_link.urdf": "T112",
    "nm_spaces.urdf": "N101",
    "nm_newline.urdf": "N101",
    "nm_leadtrail.urdf": "N101",
    "nm_frame_case.urdf": "N105",
    "mesh_package.urdf": "M106",
    "mesh_windows.urdf": "M104",
    "version_1.urdf": "X202",
    "version_1.1.urdf": "X202",
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


@pytest.mark.parametrize(("name", "codes"), (ANSWERED_THOUGH_WRONG | REMARKS).items())
def test_what_is_odd_is_said(name, codes):
    assert " ".join(sorted({finding.code for finding in oddities(ks.load(FILES / name))})) == codes


@pytest.mark.parametrize("name", [n for n, entry in MANIFEST.items() if entry["expected"] == "ok"])
def test_nothing_is_said_of_a_file_without_fault(name):
    assert oddities(ks.load(FILES / name)) == ()


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
