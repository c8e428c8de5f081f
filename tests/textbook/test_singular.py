"""Theory A5, A7, A9 to A12 and B: where the textbook arms are singular, through the library and the command line."""

import json
import math

import numpy as np
import pytest

import kinetostat as ks
from kinetostat_cli.main import run
from singular.arms import decisive, families, near_angle

HALF, PI = math.pi / 2, math.pi

# Each factorisation as families: name, kind, {joint: position}, support, inside limits.
# A surface (no position) is checked by its closed form below.
ELBOW = ("elbow", "fold")


def at(joint, position, name, kind, inside=True):
    return (name, kind, ((joint, position),), (joint,), inside)


def surface(joints, name, kind, inside=True):
    return (name, kind, (), joints, inside)


# Puma: a3 s3 + d4 c3 = 0.
PUMA_ELBOW = math.atan2(-0.4318, 0.0203)

EXPECTED = {
    # A5: det = l1 l2 s2.
    "planar_2r": [at("joint2", 0, *ELBOW), at("joint2", PI, *ELBOW)],
    "planar_2r_6_3": [at("joint2", 0, *ELBOW), at("joint2", PI, *ELBOW, inside=False)],
    "planar_2r_isotropic": [at("joint2", 0, *ELBOW), at("joint2", PI, *ELBOW)],
    # A7: in the plane, with the angle, only the elbow counts.
    "planar_3r": [at("joint2", 0, *ELBOW), at("joint2", PI, *ELBOW)],
    # Equal links: folded, axes 1 and 3 coincide and the arm spins inside.
    "isotropic_3r": [at("joint2", 0, *ELBOW), at("joint2", PI, "elbow", "tangential")],
    # A9, A10.
    "wrist_zyz": [at("joint2", 0, "wrist", "tangential"), at("joint2", PI, "wrist", "tangential", inside=False)],
    "wrist_three_roll": [at("joint2", 0, "wrist", "tangential"), at("joint2", PI, "wrist", "fold")],
    # A11: l2 l3 s3 (l2 c2 + l3 c23).
    "anthropomorphic": [
        at("joint3", 0, *ELBOW),
        at("joint3", PI, *ELBOW),
        surface(("joint2", "joint3"), "shoulder", "tangential"),
    ],
    # A12: l1 > l2 + l3, so that the wrist point never comes to the first axis.
    "torus_3r": [at("joint3", 0, *ELBOW), at("joint3", PI, *ELBOW)],
    # B.
    "puma560": [
        at("joint3", PUMA_ELBOW + PI, *ELBOW),
        at("joint3", PUMA_ELBOW, *ELBOW),
        at("joint5", 0, "wrist", "tangential"),
        at("joint5", PI, "wrist", "tangential", inside=False),
        surface(("joint2", "joint3"), "shoulder", "fold"),
    ],
    "stanford": [
        at("joint2", 0, "shoulder", "fold"),
        at("joint2", PI, "shoulder", "fold", inside=False),
        at("joint5", 0, "wrist", "tangential"),
        at("joint5", PI, "wrist", "tangential", inside=False),
        at("joint3", 0, None, "tangential", inside=False),
    ],
    "scara": [at("joint2", 0, *ELBOW), at("joint2", PI, *ELBOW, inside=False)],
    "rp": [at("joint2", -0.15, None, "tangential", inside=False)],
    "pr": [at("joint2", -HALF, *ELBOW), at("joint2", HALF, *ELBOW)],
    # Nothing is ever lost.
    "planar_1r": [],
    "skew_1p": [],
    "helical": [],
}
UR5 = [
    at("elbow_joint", 0, *ELBOW),
    at("elbow_joint", PI, *ELBOW),
    at("wrist_2_joint", 0, "wrist", "tangential"),
    at("wrist_2_joint", PI, "wrist", "tangential"),
    surface(("shoulder_lift_joint", "elbow_joint", "wrist_1_joint"), "shoulder", "fold"),
]
GENERIC_RANK = {"planar_2r": 2, "planar_3r": 3, "wrist_zyz": 3, "anthropomorphic": 3, "puma560": 6, "scara": 4}


def told(families):
    """Return found families in the words of the expected ones, positions of angles in (-pi, pi]."""
    return [
        (f["name"], f["kind"], tuple(f["positions"].items()), tuple(f["support"]), f["inside_limits"]) for f in families
    ]


def assert_same_families(found, expected, slides=()):
    """Nothing missing, nothing spurious, nothing twice."""
    left = told(found)
    assert len(left) == len(expected), left
    for name, kind, positions, support, inside in expected:
        match = [
            one
            for one in left
            if one[:2] == (name, kind)
            and one[3:] == (support, inside)
            and [joint for joint, _ in one[2]] == [joint for joint, _ in positions]
            and all(
                abs(a - b) < 1e-9 if joint in slides else near_angle(a, b) < 1e-9
                for (joint, a), (_, b) in zip(one[2], positions, strict=True)
            )
        ]
        assert len(match) == 1, (name, kind, positions, support, inside, left)


def as_data(result):
    """Return the families of a result as the JSON has them."""
    return [
        {
            "name": f.name,
            "kind": f.kind,
            "positions": f.positions,
            "support": f.support,
            "inside_limits": f.inside_limits,
        }
        for f in result.families
    ]


@pytest.fixture
def ask(capsys):
    """Run the command line, asking for JSON."""

    def call(*words):
        capsys.readouterr()
        code = run([*words, "-F", "json"])
        out, err = capsys.readouterr()
        payload = json.loads(out)
        warned = "".join(f"kinetostat: warning: {line}\n" for line in payload["warnings"])
        assert (code, err) == (0, warned)
        return payload

    return call


def slides(name):
    return {"stanford": ("joint3",), "rp": ("joint2",)}.get(name, ())


@pytest.mark.parametrize("name", EXPECTED)
def test_families_are_the_factors_of_the_determinant(name):
    result = families(f"textbook:{name}", tip(name), starts=1000)
    assert_same_families(as_data(result), EXPECTED[name], slides(name))
    assert all(family.codimension == 1 for family in result.families)
    assert all(family.tolerance == "strict" for family in result.families)
    assert result.unclassified <= 0.005 * result.converged
    assert result.certificate.agree is True
    assert name == "helical" or result.coverage.complete == result.mechanism.names


def tip(name):
    return ks.load(f"textbook:{name}").robot.default_tip()


@pytest.mark.parametrize("name", EXPECTED)
def test_families_through_the_command_line(name, ask):
    payload = ask("singular", "find", f"textbook:{name}", "--starts", "200")
    assert payload["schema"] == "kinetostat/singular find/1"
    assert_same_families(payload["result"]["families"], EXPECTED[name], slides(name))


def test_ur5_through_library_and_command_line(ask):
    assert_same_families(as_data(families("ur5_robot", "tool0", starts=1000)), UR5)
    payload = ask("singular", "find", "example:ur5_robot", "-f", "tool0", "--starts", "200")
    assert_same_families(payload["result"]["families"], UR5)


@pytest.mark.parametrize("name", GENERIC_RANK)
def test_generic_ranks(name, ask):
    result = families(f"textbook:{name}", "tool")
    assert result.mechanism.generic_rank == GENERIC_RANK[name]
    witness = result.families[0].witness
    words = ",".join(repr(float(x)) for x in witness)
    answer = ask("singular", "at", f"textbook:{name}", "-q", words)["result"]
    assert answer["singular"] is True
    assert answer["rank"] == GENERIC_RANK[name] - 1
    assert answer["generic_rank"] == GENERIC_RANK[name]


# --- surfaces: their closed form vanishes at every member that is found ----------------------------------------------


def anthropomorphic_shoulder(q):
    return 0.5 * np.cos(q["joint2"]) + 0.4 * np.cos(q["joint2"] + q["joint3"])


def puma_shoulder(q):
    two, both = q["joint2"], q["joint2"] + q["joint3"]
    return 0.4318 * np.cos(two) + 0.0203 * np.cos(both) - 0.4318 * np.sin(both)


def ur5_shoulder(q):
    two = q["shoulder_lift_joint"]
    three, four = two + q["elbow_joint"], two + q["elbow_joint"] + q["wrist_1_joint"]
    return 0.425 * np.cos(two) + 0.39225 * np.cos(three) - 0.09465 * np.sin(four)


SURFACES = {
    ("textbook:anthropomorphic", "tool"): anthropomorphic_shoulder,
    ("textbook:puma560", "tool"): puma_shoulder,
    ("ur5_robot", "tool0"): ur5_shoulder,
}


@pytest.mark.parametrize(("name", "frame"), SURFACES)
@pytest.mark.parametrize("seed", [0, 1])
def test_the_shoulders_closed_form_vanishes(name, frame, seed):
    result = families(name, frame, seed=seed, starts=200)
    found = [family for family in result.families if family.implicit]
    assert len(found) == 1
    shoulder = found[0]
    assert shoulder.name == "shoulder"
    witness = dict(zip(result.mechanism.names, shoulder.witness, strict=True))
    assert abs(SURFACES[name, frame](witness)) < 1e-9


@pytest.mark.parametrize(("name", "frame"), SURFACES)
def test_solutions_of_the_closed_form_are_singular_by_the_shoulder(name, frame):
    """The other way round: a root of the closed form, found by bisection along one joint, is singular by axis 1."""
    arm = families(name, frame).mechanism
    form, random = SURFACES[name, frame], np.random.default_rng(5)
    second = arm.names[1]
    for _ in range(3):
        q = dict(zip(arm.names, random.uniform(-2.5, 2.5, len(arm.names)), strict=True))
        low, high = None, None
        grid = np.linspace(-PI, PI, 200)
        values = form({**q, second: grid})
        changes = np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))
        low, high = grid[changes[0]], grid[changes[0] + 1]
        for _ in range(60):
            middle = (low + high) / 2
            same = np.sign(form({**q, second: middle})) == np.sign(form({**q, second: low}))
            low, high = (middle, high) if same else (low, middle)
        here = np.array([{**q, second: low}[joint] for joint in arm.names])
        assert decisive(arm, here) < 1e-9
        answer = ks.singular_at(arm.model, frame, here)
        assert answer.singular
        assert any("axis of" in cause.text and arm.names[0] in cause.joints for cause in answer.causes)


# --- A5: where the tool of the 2R arm is -----------------------------------------------------------------------------


def test_a5_the_tip_is_on_circles_of_radius_nine_and_three():
    model = ks.load("textbook:planar_2r_6_3")
    radii = {
        round(family.positions["joint2"], 9): float(np.linalg.norm(ks.fk(model, "tool", family.witness).position))
        for family in families("textbook:planar_2r_6_3", "tool").families
    }
    assert radii == {0.0: pytest.approx(9), round(PI, 9): pytest.approx(3)}


# --- A7: positions alone ---------------------------------------------------------------------------------------------


def test_a7_positions_alone_are_lost_where_both_elbows_are_straight():
    result = families("textbook:planar_3r", "tool", axes="xy")
    assert result.mechanism.generic_rank == 2
    assert all(family.codimension == 2 for family in result.families)
    found = {(round(f.positions["joint2"], 6), round(f.positions["joint3"], 6)): f.kind for f in result.families}
    straight = {(a, b) for a in (0.0, round(PI, 6)) for b in (0.0, round(PI, 6))}
    assert set(found) == straight
    assert found[0.0, 0.0] == "boundary"  # stretched: nothing leads around it
    assert found[0.0, round(PI, 6)] == found[round(PI, 6), round(PI, 6)] == "traversable"


def test_a7_at_zero_one_direction_is_lost_of_the_positions():
    answer = ks.singular_at(ks.load("textbook:planar_3r"), "tool", np.zeros(3), axes="xyz")
    assert answer.singular
    assert answer.rank == 1
    assert [list(np.round(lost.wrench, 12)) for lost in answer.lost] == [[1, 0, 0, 0, 0, 0]]
    other = ks.singular_at(ks.load("textbook:planar_3r"), "tool", [0, HALF, 0], axes="xyz")
    assert not other.singular


# --- A10 and A12 -----------------------------------------------------------------------------------------------------


def test_a10_the_three_roll_wrist_moves_inside_where_axes_1_and_3_coincide():
    answer = ks.singular_at(ks.load("textbook:wrist_three_roll"), "tool", [0.4, 0.0, -0.7])
    assert answer.kind == "tangential"
    assert len(answer.self_motions) == 1
    rates = answer.self_motions[0].rates
    np.testing.assert_allclose(np.abs(rates), [1, 0, 1], atol=1e-9)
    assert answer.self_motions[0].finite
    assert {frozenset(cause.joints) for cause in answer.causes} >= {frozenset({"joint1", "joint3"})}
    folded = ks.singular_at(ks.load("textbook:wrist_three_roll"), "tool", [0.4, PI, -0.7])
    assert folded.kind == "fold"
    assert not folded.self_motions[0].finite
    assert "one plane" in folded.causes[0].text
    assert set(folded.causes[0].joints) == {"joint1", "joint2", "joint3"}


def test_a12_the_wrist_point_is_on_a_torus():
    """Distance from the circle of radius 1 that joint 2's origin runs on: 0.8 stretched, 0.2 folded."""
    model = ks.load("textbook:torus_3r")
    for family in families("textbook:torus_3r", "tool").families:
        x, y, z = ks.fk(model, "tool", family.witness).position
        origin = ks.fk(model, "link2", family.witness).position
        tube = math.hypot(math.hypot(x, y) - 1, z - origin[2])
        assert tube == pytest.approx({0.0: 0.8}.get(round(family.positions["joint3"], 9), 0.2))


def test_scara_has_rank_three_where_it_is_straight():
    answer = ks.singular_at(ks.load("textbook:scara"), "tool", [0.3, 0.0, 0.1, -0.4])
    assert (answer.rank, answer.mechanism.generic_rank, answer.singular) == (3, 4, True)
    assert len(answer.lost) == 1  # two rows are never there: no loss of this configuration
    bent = ks.singular_at(ks.load("textbook:scara"), "tool", [0.3, 0.5, 0.1, -0.4])
    assert (bent.rank, bent.singular, bent.lost) == (4, False, ())


def test_ur5_upright_has_rank_three():
    answer = ks.singular_at(ks.load("example:ur5_robot"), "tool0", [0, -HALF, 0, -HALF, 0, 0])
    assert (answer.rank, answer.tolerance) == (3, "strict")
    assert [condition.positions for condition in answer.conditions] == [{"elbow_joint": 0.0}, {"wrist_2_joint": 0.0}]
    assert len(answer.lost) == len(answer.self_motions) == 3
