"""Runs the code of a notebook, cell by cell, without Jupyter: `python3 notebook.py corner.ipynb`. Says how long its plots took."""

import json
import sys
import time
import warnings

began = time.monotonic()
with open(sys.argv[1], encoding="utf-8") as file:
    cells = [cell for cell in json.load(file)["cells"] if cell["cell_type"] == "code"]
if any(cell["outputs"] or cell["execution_count"] is not None for cell in cells):
    sys.exit(f"{sys.argv[1]} holds outputs: clear them")

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

drawn = []


def show():
    """A page that nobody looks at is drawn all the same."""
    for number in plt.get_fignums():
        plt.figure(number).canvas.draw()
        drawn.append(time.monotonic() - began)
    plt.close("all")


plt.show = show
warnings.simplefilter("ignore")
names = {"__name__": "__main__"}
for cell in cells:
    exec("".join(cell["source"]), names)
if len(drawn) < 3:
    sys.exit("before and after were not drawn")
print(f"first plot after {drawn[0]:.1f} s, all {len(drawn)} after {drawn[-1]:.1f} s")
