"""Thousands of broken robots: each is refused in one line, or answered with finite numbers that both engines find.

KINETOSTAT_MUTATIONS sets how many (400 by default), KINETOSTAT_MUTATIONS_FIRST the first seed. To see the file of a
seed: `cd tests && python -m corpus.mutations SEED`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from corpus.mutations import DIALECTS, FILES, STORED, judge, mutated, originals

COUNT = int(os.environ.get("KINETOSTAT_MUTATIONS", "400"))
FIRST = int(os.environ.get("KINETOSTAT_MUTATIONS_FIRST", "0"))
BATCH = 100
PER_SEED = 10  # seconds


def judged(first: int, count: int) -> list[tuple[int, str, str]]:
    """Judge seeds in processes of their own: (seed, outcome, fault). A seed that kills its process is a fault too."""
    found: list[tuple[int, str, str]] = []
    seed, end = first, first + count
    while seed < end:
        command = [sys.executable, "-m", "corpus.mutations", str(seed), str(end - seed)]
        try:
            done = subprocess.run(
                command,
                cwd=Path(__file__).parents[1],
                capture_output=True,
                text=True,
                timeout=60 + PER_SEED * (end - seed),
                check=False,
            )
            ended, out, err = f"exit code {done.returncode}", done.stdout, done.stderr
        except subprocess.TimeoutExpired as error:
            ended, out, err = "no end", (error.stdout or b"").decode(), (error.stderr or b"").decode()
        lines = [json.loads(line) for line in out.splitlines() if line.endswith("}")]
        found += [(line["seed"], line["outcome"], line["fault"]) for line in lines if "outcome" in line]
        last = lines[-1]["seed"] if lines else seed
        if not lines or "outcome" not in lines[-1]:
            found.append((last, "fault", f"the process died: {ended}: {err[-500:]}"))
        seed = last + 1
    return found


def test_mutations_are_refused_or_answered_rightly():
    starts = range(FIRST, FIRST + COUNT, BATCH)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        batches = pool.map(lambda start: judged(start, min(BATCH, FIRST + COUNT - start)), starts)
    outcomes = [outcome for batch in batches for outcome in batch]
    counts = Counter(outcome for _, outcome, _ in outcomes)
    print(dict(counts))
    faults = "\n".join(f"seed {seed}: {fault}" for seed, outcome, fault in outcomes if outcome == "fault")
    assert not faults, f"{counts['fault']} of {COUNT}:\n{faults}"
    assert sum(counts.values()) == COUNT
    # The mutations must test both ends: neither all of them broken, nor none.
    assert counts["answered"] > COUNT / 10
    assert COUNT - counts["answered"] > COUNT / 10


def test_a_seed_always_gives_the_same_file():
    assert mutated(7) == mutated(7)
    assert len({mutated(seed)[1] for seed in range(50)}) > 45


def test_what_is_mutated_is_whole_itself(tmp_path):
    assert len(originals()) > len(STORED) + len(DIALECTS)
    for name, data in originals().items():
        assert judge(data, tmp_path / "robot.urdf") == "answered", name


@pytest.mark.parametrize("program", ["import os; os.kill(os.getpid(), 11)", "import time; time.sleep(60)"])
def test_a_process_that_dies_or_hangs_is_noticed(program, monkeypatch):
    """The harness itself: its child is replaced by one that names a seed, and then crashes or hangs."""
    real = subprocess.run

    def instead(command, **options):
        child = [sys.executable, "-c", f"print('{{\"seed\": {command[-2]}}}', flush=True); {program}"]
        return real(child, **(options | {"timeout": 2}))

    monkeypatch.setattr(subprocess, "run", instead)
    assert [(seed, outcome) for seed, outcome, _ in judged(3, 2)] == [(3, "fault"), (4, "fault")]


def test_the_files_to_mutate_are_stored_here():
    assert all((FILES / name).is_file() for name in STORED)
