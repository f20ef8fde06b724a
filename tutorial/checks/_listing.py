"""Source as a notebook has it: without annotations and docstrings, so that it needs no imports for them."""

from __future__ import annotations

import ast
import inspect
import re
from typing import Any

__all__ = ["listing"]


def listing(part: Any) -> str:
    """Return the source of a class or function, ready to be pasted into a cell.

    Its comments stay, and so do its blank lines.

    Args:
        part: the class or function, written at the top level of its module.
    """
    shown = source = inspect.getsource(part).rstrip()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.arg(annotation=ast.expr() as kind) | ast.AnnAssign(annotation=kind):
                shown = shown.replace(f": {ast.get_source_segment(source, kind)}", "")
            case ast.FunctionDef(returns=ast.expr() as kind):
                shown = shown.replace(f" -> {ast.get_source_segment(source, kind)}:", ":")
            case ast.Expr(ast.Constant(str())):
                shown = re.sub(rf"\n *{re.escape(ast.get_source_segment(source, node) or '')}", "", shown)
    return re.sub(r":\n\n", ":\n", shown)
