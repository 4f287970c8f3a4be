"""Executes a notebook; its pictures are left in a folder. `python notebook.py NOTEBOOK FOLDER [--save]`; --save keeps its outputs in it."""

# Implements: PYT-030.

import base64
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

notebook, folder = map(Path, sys.argv[1:3])
folder.mkdir(parents=True, exist_ok=True)
for old in folder.glob("figure-*.png"):
    old.unlink()
document = nbformat.read(notebook, as_version=4)
NotebookClient(document, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}}).execute()
number = 0
for cell in document.cells:
    cell.metadata.pop("execution", None)
    for output in cell.get("outputs", []):
        print(output.get("text", ""), end="")
        if "image/png" in output.get("data", {}):
            number += 1
            (folder / f"figure-{number}.png").write_bytes(base64.b64decode(output.data["image/png"]))
print(f"{notebook.name}: {len(document.cells)} cells, {number} pictures in {folder}")
if "--save" in sys.argv:
    nbformat.write(document, notebook)
