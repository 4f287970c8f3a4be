"""Writes vectors/*.json and vectors/manifest.json; with --check, says instead whether the files are the same.

    python3 vectors/generate.py [--check]

Needs mpmath 1.3.0 (vectors/requirements.txt). The same files come out on every machine, byte for byte.
"""

import hashlib
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import mpmath
from generator import VERSION, all_groups

HERE = Path(__file__).parent
NOT_CASES = {"schema.json", "manifest.json"}


def manifest(files, groups):
    """The SHA-256 of each file, and of the suite: of the lines `<sha256>  <file name>` in the order of the names."""
    sums = {name: hashlib.sha256(text).hexdigest() for name, text in sorted(files.items())}
    lines = "".join(f"{digest}  {name}\n" for name, digest in sums.items())
    return {
        "schema": "palpate-vectors-manifest",
        "schema_version": 1,
        "generator_version": VERSION,
        "suite_sha256": hashlib.sha256(lines.encode()).hexdigest(),
        "cases": sum(len(group.cases) for group in groups),
        "refused": sum("error" in case for group in groups for case in group.cases),
        "files": [{"name": name, "sha256": digest} for name, digest in sums.items()],
    }


def main():
    if mpmath.__version__ != "1.3.0":
        sys.exit(f"mpmath is {mpmath.__version__}, but vectors/requirements.txt asks for 1.3.0")
    groups = all_groups()
    files = {f"{group.name}.json": group.text().encode() for group in groups}
    files["schema.json"] = (HERE / "schema.json").read_bytes()
    summary = json.dumps(manifest(files, groups), indent=1, ensure_ascii=False) + "\n"
    files["manifest.json"] = summary.encode()
    if "--check" in sys.argv[1:]:
        stale = [
            name for name, text in files.items() if not (HERE / name).exists() or (HERE / name).read_bytes() != text
        ]
        present = {path.name for path in HERE.glob("*.json")}
        stale += sorted(present - set(files) - NOT_CASES)
        if stale:
            sys.exit("not as generated: " + ", ".join(sorted(stale)))
        print(f"{len(files)} files are as generated")
        return
    for name, text in files.items():
        (HERE / name).write_bytes(text)
    print(summary)


if __name__ == "__main__":
    main()
