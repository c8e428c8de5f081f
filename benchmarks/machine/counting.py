"""How many floating point operations compiled code executes: walked through (`stepping.cpp`) and read.

Virtual machines seldom have hardware counters; a debugger's steps and a disassembler (objdump) count the same thing,
exactly: each executed add, multiply, divide and square root of float64, times the numbers in its register, a fused
multiply-add as two. Comparisons, minima, roundings and moves are not counted, and neither is what a lane computes in
vain (a mask): it is counted as computed, as hardware counts it.
"""

import re
import subprocess
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from machine.building import built

HERE = Path(__file__).parent
FLOPS = re.compile(r"v?(?P<what>add|sub|mul|div|sqrt|fn?m(?:add|sub)(?:\d{3})?)(?P<how>[ps])d")
INSTRUCTION = re.compile(r"\s*([0-9a-f]+):\s+(?:\{\w+\} )?(\S+)\s*(.*)")
SLOT = 32  # bytes between two instructions in the file of code
WIDTHS = (("%zmm", 8), ("%ymm", 4), ("%xmm", 2))


@dataclass(frozen=True)
class Count:
    """What was executed: instructions of code compiled at run time, flops, of these slow ones, and those in vectors."""

    instructions: int
    flops: int
    slow: int  # divisions and square roots, which take several cycles each
    packed: int  # flops in whole vectors of the widest kind


def flops_of(mnemonic: str, operands: str) -> tuple[int, bool, bool]:
    """Return the flops of an instruction, whether it is a division or root, and whether it is 8 wide."""
    match = FLOPS.fullmatch(mnemonic)
    if match is None:
        return 0, False, False
    width = 1 if match["how"] == "s" else next((n for name, n in WIDTHS if name in operands), 2)
    fused = match["what"].startswith("f")
    return width * (2 if fused else 1), match["what"] in ("div", "sqrt"), width == WIDTHS[0][1]


def counted(command: list[str]) -> Count:
    """Return what a command executes between its two stops.

    Raises:
        OSError: no compiler or disassembler, or no right to trace.
        subprocess.CalledProcessError: the command failed.
    """
    stepping = built(HERE / "stepping.cpp")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "steps"
        subprocess.run([stepping, str(out), *command], check=True, capture_output=True)
        counts = [int(line.split()[1]) for line in Path(f"{out}.counts").read_text().splitlines()]
        read = ["objdump", "-D", "--no-show-raw-insn", "-b", "binary", "-m", "i386:x86-64", f"{out}.code"]
        text = subprocess.run(read, check=True, capture_output=True, text=True).stdout
    kinds = {int(m[1], 16): (m[2], m[3]) for m in map(INSTRUCTION.match, text.splitlines()) if m}
    total = Counter[str]()
    for i, times in enumerate(counts):
        mnemonic, operands = kinds[SLOT * i]
        flops, slow, packed = flops_of(mnemonic, operands)
        total["flops"] += flops * times
        total["slow"] += flops * times if slow else 0
        total["packed"] += flops * times if packed else 0
    return Count(sum(counts), total["flops"], total["slow"], total["packed"])
