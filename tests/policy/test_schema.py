"""The JSON schema that ships for editors: up to date, and of the same mind as the reader."""

from __future__ import annotations

import json
import tomllib

import jsonschema
import pytest

from kinetostat import UsageError
from kinetostat.policy import schema
from kinetostat.policy.expectations import KINDS
from kinetostat.policy.settings import read_settings
from policy.policies import written
from policy.test_judging import EVERY
from policy.test_settings import REFUSED, WHOLE

SHIPPED = json.loads(schema.SHIPPED.read_text())
VALIDATOR = jsonschema.Draft202012Validator(SHIPPED)
# What the schema cannot say: it needs two keys, or the robot's words.
BEYOND = {
    "no bound", "bounds the wrong way round", "limits of nothing", "words and numbers", "an axis", "a pose",
    "poses twice", "nothing to hold", "nan", "inf in a list", "a number that no float holds", "half a sample",
}  # fmt: skip


def test_the_one_that_ships_is_up_to_date():
    assert schema.SHIPPED.read_text() == schema.text(), "renew it: python -m kinetostat.policy.schema"


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(SHIPPED)


def test_every_key_is_described():
    tables = [SHIPPED, *SHIPPED["$defs"].values()]
    assert len(tables) == len(KINDS) + 4
    for table in tables:
        assert table["description"]
        assert table["additionalProperties"] is False
        for key, value in table["properties"].items():
            assert key == "kind" or value.get("description"), (table["title"], key)
            assert key != "place"


@pytest.mark.parametrize("kind", EVERY)
def test_it_takes_what_the_reader_takes(tmp_path, kind):
    text = f'{WHOLE}\n[[robots.expect]]\nkind = "{kind}"\n{EVERY[kind]}\n'
    read_settings(written(tmp_path, text))
    VALIDATOR.validate(tomllib.loads(text))


@pytest.mark.parametrize("case", [c for c in REFUSED if "TOML" not in REFUSED[c][2] and c not in BEYOND])
def test_it_refuses_what_the_reader_refuses(case):
    assert list(VALIDATOR.iter_errors(tomllib.loads(REFUSED[case][0])))


@pytest.mark.parametrize("case", sorted(BEYOND))
def test_what_it_cannot_say_the_reader_says(tmp_path, case):
    with pytest.raises(UsageError):
        read_settings(written(tmp_path, REFUSED[case][0]))
