"""The README's code runs, and the notebook, whose plots are labelled."""

import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

PACKAGE = Path(__file__).resolve().parents[1]

LABELLED = """
figures = [plt.figure(number) for number in plt.get_fignums()]
axes = [axis for figure in figures for axis in figure.axes]
assert len(figures) >= 4, figures
for axis in axes:
    for text in (axis.get_title(), axis.get_xlabel(), axis.get_ylabel()):
        assert text, axis
    assert axis.get_legend() and axis.lines, axis
"""


def test_the_code_of_the_readme_runs(capsys):
    text = (PACKAGE / "README.md").read_text()
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    lines = [line for line in code.splitlines() if line]
    assert len(lines) == 10
    exec(code, {})
    assert re.fullmatch(r"\d+ N of 3549 N\n", capsys.readouterr().out)


# What Jupyter's own packages warn of is not ours.
@pytest.mark.filterwarnings("default")
def test_the_notebook_runs_and_its_plots_are_labelled(monkeypatch):
    path = PACKAGE / "notebooks/muscle.ipynb"
    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        assert not cell.get("outputs"), "the repository has the notebook without outputs"
    # The inline backend would close the figures after each cell.
    monkeypatch.setenv("MPLBACKEND", "agg")
    notebook.cells.append(nbformat.v4.new_code_cell(LABELLED))
    resources = {"metadata": {"path": path.parent}}
    NotebookClient(notebook, timeout=120, resources=resources).execute()
