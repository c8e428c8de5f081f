"""What is told of the keys of a settings file: true, complete, and what the reader takes."""

from __future__ import annotations

import importlib.util
import re
import tomllib
from pathlib import Path

import pytest

from kinetostat.policy.expectations import KINDS
from kinetostat.policy.kinds.common import PLACE
from kinetostat.policy.manual import chain_page, check_page, kind_pages, page, robot_page
from kinetostat.policy.settings import read_settings
from kinetostat.policy.table import ChainSettings, CheckSettings, RobotSettings
from policy.policies import written
from policy.test_schema import VALIDATOR

DOCS = Path(__file__).parents[2] / "docs"
ROBOT = '[[robots]]\npath = "arm.urdf"\n'
PAGES = [check_page(), robot_page(), chain_page(), *kind_pages()]


def shipped():
    return (DOCS / "policy.md").read_text(encoding="utf-8")


def test_the_page_is_up_to_date():
    spec = importlib.util.spec_from_file_location("policy_page", DOCS / "policy.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.page() == shipped(), "python docs/policy.py"


def test_every_example_of_the_page_is_read(tmp_path):
    blocks = re.findall(r"```toml\n(.*?)```", shipped(), re.DOTALL)
    assert len(blocks) == len(KINDS) + 4
    for block in blocks:
        text = ROBOT + block if block.startswith("[[robots.expect]]") else block
        settings = read_settings(written(tmp_path, text))
        VALIDATOR.validate(tomllib.loads(text))
        if text is not block:
            ((one,),) = (robot.expect for robot in settings.robots)
            assert f'kind = "{one.kind}"' in block


@pytest.mark.parametrize("told", PAGES, ids=lambda told: told.name)
def test_every_key_is_told_and_no_other(told):
    tables = {"[check]": CheckSettings, "[[robots]]": RobotSettings, "[[robots.chains]]": ChainSettings}
    struct = (tables | KINDS)[told.name]
    known = set(struct.__struct_encode_fields__) - {PLACE, "expect", "chains"}
    assert {key.name for key in told.keys} == known
    assert all(key.description and key.type for key in told.keys)
    assert told.aim


EXAMPLES = [(kind, key.name, one) for kind in KINDS for key in page(kind).keys for one in key.examples]


@pytest.mark.parametrize(("kind", "key", "example"), EXAMPLES)
def test_every_example_of_a_key_is_taken(tmp_path, kind, key, example):
    lines = [line for line in page(kind).example.splitlines() if not line.startswith(f"{key} =")]
    if (kind, key) == ("reaches", "file"):
        lines = [line for line in lines if not line.startswith("poses")]
    text = ROBOT + "\n".join([*lines, f"{key} = {example}"])
    (robot,) = read_settings(written(tmp_path, text)).robots
    assert len(robot.expect) == 1
    VALIDATOR.validate(tomllib.loads(text))


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_told_to_be_the_default_is(tmp_path, kind):
    example = page(kind).example
    plain = read_settings(written(tmp_path, ROBOT + example)).robots[0].expect[0]
    for key in page(kind).keys:
        if key.default and f"{key.name} =" not in example:
            (robot,) = read_settings(written(tmp_path, f"{ROBOT}{example}\n{key.name} = {key.default}")).robots
            assert robot.expect[0] == plain, key.name


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_told_to_be_required_is(tmp_path, kind):
    from kinetostat import UsageError

    for key in page(kind).keys:
        if key.required:
            lines = [line for line in page(kind).example.splitlines() if not line.startswith(f"{key.name} =")]
            with pytest.raises(UsageError, match=f"'{key.name}' is missing"):
                read_settings(written(tmp_path, ROBOT + "\n".join(lines)))


@pytest.mark.parametrize(
    ("kind", "key", "type_", "unit", "default"),
    [
        ("holds", "payload", "number from 0 up to 1000000000", "kg", "0.0"),
        ("holds", "wrench", "list of 6 numbers", "N, Nm", ""),
        ("holds", "effort-limits", "table of numbers above 0", "Nm, N", ""),
        ("holds", "at", "text or list of numbers or texts", "rad, m", '"zero"'),
        ("reach", "at-least", "number", "m", ""),
        ("mass", "at-most", "number from 0", "kg", ""),
        ("symmetry", "plane", '"xy" or "xz" or "yz"', "", '"xz"'),
        ("symmetry", "masses", "true or false", "", "true"),
        ("degrees-of-freedom", "equals", "whole number from 0 up to 1000", "", ""),
        ("reaches", "poses", "list of texts or lists of numbers", "m, rad", ""),
        ("joint-limits", "joints", "list of texts", "", ""),
    ],
)
def test_how_keys_are_told(kind, key, type_, unit, default):
    (told,) = (one for one in page(kind).keys if one.name == key)
    assert (told.type, told.unit, told.default) == (type_, unit, default)
