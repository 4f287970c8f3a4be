"""The spread of the instruction counts that `cargo bench -p palpate-kernel-bench` has left behind: one step of the
servo kernel must take the same on every path, within 10 % of the middle. Ends with 1 otherwise.

Verifies: SRV-060.
"""

import pathlib
import re
import sys

folder = pathlib.Path("target/gungraun/palpate-kernel-bench/instructions")
counts = {}
for file in folder.glob("kernel/*/callgrind.*.out"):
    counts[file.parent.name] = int(re.search(r"^summary: (\d+)", file.read_text(), re.MULTILINE).group(1))
if len(counts) < 15:
    sys.exit(f"only {len(counts)} paths in {folder}, but at least 15 are needed: run the bench first")
least, most = min(counts, key=counts.get), max(counts, key=counts.get)
low, high = counts[least], counts[most]
spread = (high - low) / (high + low)
print(f"{low} instructions ({least}) to {high} ({most}): within {100 * spread:.1f} % of the middle")
sys.exit(spread > 0.10)
