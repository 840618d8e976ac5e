"""Small faults of source files, by the same kinds in Python (its syntax tree) and in C++ (its tokens)."""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

COMPARE = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.GtE),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
ARITHMETIC = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult}
ARITHMETIC |= {ast.FloorDiv: ast.Mult, ast.Mod: ast.Mult}

CPP_OPERATORS = {
    r" < ": (" <= ", " > "),
    r" > ": (" >= ", " < "),
    r" <= ": (" < ", " >= "),
    r" >= ": (" > ", " <= "),
    r" == ": (" != ",),
    r" != ": (" == ",),
    r" && ": (" || ",),
    r" \|\| ": (" && ",),
    r" \+ ": (" - ",),
    r" - ": (" + ",),
    r" \* ": (" / ",),
    r" / ": (" * ",),
    r" \+= ": (" -= ",),
    r" -= ": (" += ",),
    r"(?<=[(=,] )-(?=[\w(])|(?<=\()-(?=[\w(])|(?<=return )-": ("",),
    r"!(?=[\w(])": ("",),
    r"\btrue\b": ("false",),
    r"\bfalse\b": ("true",),
}
CPP_NUMBER = re.compile(r"(?<![\w.\"])(\d+\.?\d*(?:e[-+]?\d+)?)(?![\w.])")
CPP_CALL = re.compile(
    r"^\s+(?!return|throw|const |using|auto|else|case|break|continue|delete)[\w.\->:\[\]]+(?:\(.*\)| [-+*/]?= .*);$"
)
CPP_IF = re.compile(r"\bif \((?!constexpr)(.+)\) (?=return|throw|continue|break|\w[\w.]* [-+]?= )")


@dataclass(frozen=True)
class Mutation:
    """One fault: line, what it says, and the whole text of the file with it."""

    line: int
    fault: str
    text: Callable[[], str]


def python_mutations(source: str) -> Iterator[Mutation]:
    """All faults of a Python file, in its order."""
    nodes = list(ast.walk(ast.parse(source)))
    ignored = {id(child) for node in nodes for child in _ignored(node)}
    for index, node in enumerate(nodes):
        if id(node) in ignored:
            continue
        for variant, changed in enumerate(_python_variants(node)):

            def text(index: int = index, variant: int = variant) -> str:
                tree = ast.parse(source)
                target = list(ast.walk(tree))[index]
                replacement = list(_python_variants(target))[variant]
                return ast.unparse(ast.fix_missing_locations(_Replace(target, replacement).visit(tree)))

            before, after = (" ".join(ast.unparse(n).split()) for n in (node, changed))
            yield Mutation(node.lineno, f"{before[:90]}  ->  {after[:90]}", text)


def _ignored(node: ast.AST) -> list[ast.AST]:
    """Annotations, docstrings and formats are no statements about behaviour."""
    if isinstance(node, ast.FormattedValue):
        return list(ast.walk(node.format_spec)) if node.format_spec else []
    if isinstance(node, (ast.AnnAssign, ast.arg)) and node.annotation:
        return list(ast.walk(node.annotation))
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.returns:
        return list(ast.walk(node.returns))
    return [node] if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) else []


def _python_variants(node: ast.AST) -> Iterator[ast.AST]:
    """The node with each fault that fits it."""

    def changed(**fields: object) -> ast.AST:
        other = copy.copy(node)
        for name, value in fields.items():
            setattr(other, name, value)
        return other

    match node:
        case ast.Compare():
            for other in COMPARE[type(node.ops[0])]:
                yield changed(ops=[other(), *node.ops[1:]])
        case ast.BinOp() if type(node.op) in ARITHMETIC and not any(map(_is_text, (node.left, node.right))):
            yield changed(op=ARITHMETIC[type(node.op)]())
        case ast.AugAssign() if type(node.op) in ARITHMETIC:
            yield changed(op=ARITHMETIC[type(node.op)]())
            yield ast.copy_location(ast.Pass(), node)
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node.operand
        case ast.BoolOp():
            yield changed(op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
        case ast.Constant(value=bool()):
            yield changed(value=not node.value)
        case ast.Constant(value=int() | float()):
            yield changed(value=node.value + 1 if isinstance(node.value, int) else 2 * node.value or 1.0)
            if isinstance(node.value, int):
                yield changed(value=node.value - 1)
        case ast.IfExp():
            yield changed(body=node.orelse, orelse=node.body)
        case ast.If() | ast.While():
            yield changed(test=ast.copy_location(ast.UnaryOp(ast.Not(), node.test), node.test))
        case ast.Call() if len(node.args) > 1 and not any(isinstance(a, ast.Starred) for a in node.args):
            yield changed(args=[node.args[1], node.args[0], *node.args[2:]])
        case ast.Expr() | ast.Raise():
            yield ast.copy_location(ast.Pass(), node)
        case ast.Return() if node.value is not None:
            yield changed(value=ast.copy_location(ast.Constant(None), node.value))


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


class _Replace(ast.NodeTransformer):
    """Puts another node in the place of one."""

    def __init__(self, target: ast.AST, replacement: ast.AST):
        self._target, self._replacement = target, replacement

    def visit(self, node: ast.AST) -> ast.AST:
        return self._replacement if node is self._target else self.generic_visit(node)


def cpp_mutations(source: str) -> Iterator[Mutation]:
    """All faults of a C++ file, in its order; comments, texts and directives are passed over."""
    lines = source.splitlines()
    for number, line in enumerate(lines):
        code = re.sub(r'"(?:[^"\\]|\\.)*"', lambda found: "\0" * len(found[0]), line.partition("//")[0])
        if re.match(r"\s*(#|using|template|namespace|static_assert|/?\*)", code):
            continue
        for begin, end, new in _cpp_variants(code):

            def text(number: int = number, begin: int = begin, end: int = end, new: str = new) -> str:
                changed = lines[number][:begin] + new + lines[number][end:]
                return "\n".join([*lines[:number], changed, *lines[number + 1 :], ""])

            after = (line[:begin] + new + line[end:]).strip()
            yield Mutation(number + 1, f"{line.strip()[:90]}  ->  {after[:90]}", text)


def _cpp_variants(code: str) -> Iterator[tuple[int, int, str]]:
    """Begin and end of what is replaced in a line, and by what."""
    for pattern, replacements in CPP_OPERATORS.items():
        for found in re.finditer(pattern, code):
            for new in replacements:
                yield found.start(), found.end(), new
    for found in CPP_NUMBER.finditer(code):
        number = found[0]
        yield found.start(), found.end(), str(int(number) + 1) if number.isdigit() else f"(2 * {number})"
    for found in CPP_IF.finditer(code):
        yield found.start(1), found.end(1), f"!({found[1]})"
    if CPP_CALL.match(code):
        yield len(code) - len(code.lstrip()), len(code.rstrip()), ";"
