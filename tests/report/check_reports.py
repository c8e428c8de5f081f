"""Reports of `check`, made by hand, and at random: what renderers are tried on."""

from hypothesis import strategies as st

from kinetostat.analysis.agreement import Agreement, Disagreement
from kinetostat.gate.checking import judged
from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.policy.outcome import Outcome

LIMIT = '    <limit lower="2" upper="-2" effort="10" velocity="1"/>'
ELBOW = "<joint name='elbow'>"
HOSTILE = (
    "'\"><script>alert(1)</script><b>\n::error::planted\r\x1b[31m%0A|`x`](http://evil.example)[a](0)@octocat #1 "
    "**b** _i_ ${arm} {0} {{1}} \u202eright to left\u202c \u05e9\u05dc\u05d5\u05dd \U0001f600 \ud800\udcff ]]> "
    "&amp; <!-- --> www.evil.example \x00\x07\x9b\ufffe"
)


def finding(severity=Severity.ERROR, line=3, **changes):
    given = {
        "code": "J103",
        "name": "swapped-limits",
        "severity": severity,
        "message": "lower 2 rad is above upper -2 rad",
        "line": line,
        "element": f"{ELBOW}<limit>",
        "hint": "swap lower and upper",
        "attribute": "lower",
    }
    return Finding(**given | changes)


AGREED = Agreement(("pinocchio", "screw", "yourdfpy"), 12, 20, 4.4e-16, 1e-12, notes=("yourdfpy: 3 configurations",))
APART = Agreement(
    ("pinocchio", "screw", "yourdfpy"),
    12,
    20,
    2e-3,
    1e-12,
    (
        Disagreement(
            "placement", "screw", ("screw", "pinocchio"), "tool0", {"elbow": 0.25, "wrist": 0.0}, 2e-3, 1e-12, "m"
        ),
    ),
)
MET = Outcome("total-mass", "total mass", True, "at most 20 kg", "18.2 kg", {}, "kinetostat.toml:4")
UNMET = Outcome(
    "holds", "holds 5 kg at tool0", False, "at most 80 % of effort", "93 %", {"elbow": 1.5}, "kinetostat.toml:12"
)
UNJUDGED = Outcome(
    "holds", "holds 5 kg at hand", None, "at most 80 %", "there is no frame 'hand'", {}, "kinetostat.toml:19"
)

GOOD = FileCheck("robots/good.urdf", Verdict.PASS, (finding(Severity.INFO, 0),), AGREED, (MET,), suppressed=1, known=2)
BAD = FileCheck(
    "robots/bad.urdf",
    Verdict.FAIL,
    (
        finding(),
        finding(Severity.WARNING, 7, code="N201", name="odd-name", attribute="", hint=""),
        finding(Severity.INFO, 9, code="N202", name="a-name"),
        finding(Severity.WARNING, 4, file="robots/bad.srdf", code="N301", name="group", element="<group name='arm'>"),
    ),
    APART,
    (MET, UNMET, UNJUDGED),
    skipped={"K101": "the chain is too long", "K102": "the chain is too long", "M101": "no package"},
    lines={("", 3): LIMIT, ("robots/bad.srdf", 4): '\t<group name="arm" lower="1">'},
    seconds=0.25,
)
CRASH = FileCheck("robots/crash.urdf", Verdict.CRASHED, reason="no answer after 60 s")
XACRO = FileCheck("robots/arm.urdf.xacro", Verdict.FAIL, (finding(line=120),), None, expanded=True)
REPORT = CheckReport((GOOD, BAD, CRASH, XACRO))
EMPTY = CheckReport(())


def hostile_report():
    """A report in which everything that can come from a file or a policy is hostile."""
    nasty = finding(message=HOSTILE, element=HOSTILE, hint=HOSTILE, attribute=HOSTILE)
    apart = Disagreement(HOSTILE, "", (HOSTILE, "screw"), HOSTILE, {HOSTILE: 1.0}, float("nan"), 1e-9, "m")
    file = FileCheck(
        f"robots/{HOSTILE}.urdf",
        Verdict.FAIL,
        (nasty, finding(file=f"{HOSTILE}.srdf", message=HOSTILE)),
        Agreement((HOSTILE, "screw"), 1, 1, float("inf"), 1e-12, (apart,), (HOSTILE,)),
        tuple(
            Outcome(HOSTILE, HOSTILE, met, HOSTILE, HOSTILE, {HOSTILE: float("nan")}, HOSTILE) for met in (False, None)
        ),
        skipped={HOSTILE: HOSTILE},
        lines={("", 3): HOSTILE, (f"{HOSTILE}.srdf", 3): HOSTILE},
    )
    return CheckReport((file, FileCheck(HOSTILE, Verdict.CRASHED, reason=HOSTILE)))


findings = st.builds(
    finding,
    severity=st.sampled_from(Severity),
    line=st.integers(0, 5),
    message=st.text(max_size=30),
    element=st.text(max_size=20),
    file=st.sampled_from(["", "robots/a.srdf"]),
)
outcomes = st.builds(
    Outcome,
    kind=st.just("holds"),
    title=st.text(max_size=20),
    met=st.sampled_from([True, False, None]),
    wanted=st.text(max_size=10),
    found=st.text(max_size=10),
)
files = st.builds(
    FileCheck,
    path=st.text(min_size=1, max_size=20),
    verdict=st.sampled_from([Verdict.PASS, Verdict.CRASHED]),
    findings=st.lists(findings, max_size=4).map(tuple),
    agreement=st.sampled_from([None, AGREED, APART]),
    outcomes=st.lists(outcomes, max_size=3).map(tuple),
    skipped=st.dictionaries(st.sampled_from(["K101", "K102", "crosscheck"]), st.text(max_size=10), max_size=3),
    expanded=st.booleans(),
    lines=st.dictionaries(st.tuples(st.just(""), st.integers(1, 5)), st.text(max_size=100), max_size=3),
)


@st.composite
def reports(draw):
    """Reports with the verdicts that the gate gives."""
    fail_on = draw(st.sampled_from(Severity))
    given = draw(st.lists(files, max_size=4))
    return CheckReport(tuple(judged(file, fail_on) for file in given), fail_on)
