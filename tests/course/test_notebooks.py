"""Checks that nbval leaves out: it accepts cells that never ran, images, and unfinished cells."""

import ast
import re
from pathlib import Path

import nbformat
import pytest
from steps import BESIDE

from tutorial import controllers
from tutorial.checks.catalogue import exercises
from tutorial.controller import SimpleController
from tutorial.program.controller_files import controller_names
from tutorial.system.paths import HOME


def teaches(notebook, module):
    """Return whether a notebook teaches a controller: its name is the controller's, or the common prefix of two."""
    return f"{module.stem}_".startswith(f"{notebook.stem.partition('_')[2]}_")


NOTEBOOKS = sorted((HOME / "notebooks").glob("*.ipynb"))
FILES = sorted(path for path in Path(controllers.__path__[0]).glob("[!_]*.py") if path.stem not in BESIDE)
LESSONS = [(path, module) for path in NOTEBOOKS for module in FILES if teaches(path, module)]
OWN = controller_names()


@pytest.fixture(params=NOTEBOOKS, ids=lambda path: path.stem)
def notebook(request):
    return nbformat.read(request.param, as_version=4)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def test_there_is_a_notebook_for_each_controller():
    assert [module for _, module in sorted(LESSONS, key=lambda lesson: lesson[1])] == FILES
    without = [path.stem for path in NOTEBOOKS if not any(teaches(path, module) for module in FILES)]
    assert without == ["0_setup", "10_services", "9_nothing_arrives"]


def test_outputs_come_from_one_complete_run(notebook):
    nbformat.validate(notebook)
    cells = code_cells(notebook)
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert notebook.metadata.language_info == {"name": "python"}
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    assert not re.search(r"/(home|root|tmp)/|site-packages|0x[0-9a-f]{6,}", nbformat.writes(notebook))
    for cell in cells:
        for output in cell.outputs:
            assert output.output_type != "error", cell.source
            assert output.get("name") != "stderr" or cell.metadata.get("reason"), cell.source
            kinds = output.get("data", {})  # JupyterLab shows an error in place of a widget without a kernel
            assert "application/vnd.jupyter.widget-view+json" not in kinds, cell.source
            assert all(output.metadata.get(kind, {}).get("alt") for kind in kinds if kind.startswith("image/"))


def test_skipping_a_comparison_needs_a_reason(notebook):
    for cell in code_cells(notebook):
        tags = set(cell.metadata.get("tags", []))
        assert tags <= {"nbval-ignore-output"}, cell.source
        assert bool(tags) == bool(cell.metadata.get("reason")), cell.source


def test_the_last_cell_closes_everything(notebook):
    assert code_cells(notebook)[-1].source.endswith("close_all()")


@pytest.mark.parametrize(("notebook_file", "module"), LESSONS, ids=[module.stem for _, module in LESSONS])
def test_the_librarys_controller_is_the_notebooks_code(notebook_file, module):
    """Docstrings, annotations and comments may differ."""
    written = {}
    for cell in code_cells(nbformat.read(notebook_file, as_version=4)):
        written.update(definitions(cell.source))
    kept = definitions(module.read_text())
    assert kept
    for name, code in kept.items():
        assert written.get(name) == code, name


def definitions(source):
    """Return the name and code of every class, function and constant that a source defines."""
    found = {}
    for node in Bare().visit(ast.parse(source, type_comments=False)).body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found[node.name] = ast.unparse(node)
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id.isupper():
            found[node.targets[0].id] = ast.unparse(node)
    return found


class Bare(ast.NodeTransformer):
    """Removes the parts that the notebooks leave out."""

    def visit_FunctionDef(self, node):
        node.returns = None
        for argument in node.args.args:
            argument.annotation = None
        return self.undocumented(node)

    def visit_ClassDef(self, node):
        return self.undocumented(node)

    def visit_AnnAssign(self, node):
        return ast.copy_location(ast.Assign([node.target], node.value), node)

    def undocumented(self, node):
        if ast.get_docstring(node) is not None:
            node.body = node.body[1:]
        return self.generic_visit(node)


ASKED = [each for those in exercises().values() for each in those]
CONTROLLERS_ASKED = [each.name for each in ASKED if SimpleController in getattr(each.right_answer, "__mro__", ())]


def test_answers_to_exercises_are_folded(notebook):
    asked = any(f"await {name}.check(" in cell.source for name in CONTROLLERS_ASKED for cell in notebook.cells)
    answers = ["class AimedJoint:", "class Shaker:", "class StampPairs:", "if isfinite(axis)"]
    answers += [f"class {name}(" for name in OWN if asked]
    for cell in code_cells(notebook):
        folded = cell.metadata.get("jupyter", {}).get("source_hidden", False)
        assert folded == any(code in cell.source for code in answers), cell.source
