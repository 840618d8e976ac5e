"""The faults that scripts/mutants plants: all kinds, in the right places, and nothing that cannot be read."""

from __future__ import annotations

import ast

from mutants import cpp_faults, drawn, python_faults

PYTHON = '''def f(a: int = 1, *b) -> float:
    """Text 1 + 2."""
    if not a <= 2.5 and b:  # αβγ + 1
        g(a - 1, b)
    return a[0] if b else f"{a + 1:.3f}"
'''
CPP = """// a + b
void f(int a) {
  if (a < 2 && !b) return -1;
  x[3] += 2.5 * g("a + b");
  g(a, true);
}
"""


def changed_lines(text: str, faults) -> set[str]:
    """The lines that faults make, one of each."""
    found = set()
    for begin, end, new in faults(text):
        changed = (text[:begin] + new + text[end:]).splitlines()
        found |= {line.strip() for line in changed} - {line.strip() for line in text.splitlines()}
    return found


def test_python_gets_each_kind_of_fault_where_its_syntax_has_it():
    assert changed_lines(PYTHON, python_faults) == {
        "def f(a: int = 2, *b) -> float:",
        "def f(a: int = (0), *b) -> float:",
        "if (not (not a <= 2.5 and b)):  # αβγ + 1",
        "if ((not a <= 2.5) or (b)):  # αβγ + 1",
        "if (a <= 2.5) and b:  # αβγ + 1",
        "if not (a < 2.5) and b:  # αβγ + 1",
        "if not (a >= 2.5) and b:  # αβγ + 1",
        "if not a <= 5.0 and b:  # αβγ + 1",
        "pass",
        "g(b, a - 1)",
        "g(((a) + (1)), b)",
        "g(a - 2, b)",
        "g(a - (0), b)",
        "return None",
        'return a[0] if (not (b)) else f"{a + 1:.3f}"',
        'return a[1] if b else f"{a + 1:.3f}"',
        'return a[(-1)] if b else f"{a + 1:.3f}"',
    }


def test_cpp_gets_each_kind_of_fault_outside_of_comments_and_texts():
    assert changed_lines(CPP, cpp_faults) == {
        "if (a <= 2 && !b) return -1;",
        "if (a > 2 && !b) return -1;",
        "if (a < 2 || !b) return -1;",
        "if (a < 2 && b) return -1;",
        "if (a < 2 && !b) return 1;",
        "if (!(a < 2 && !b)) return -1;",
        "if (a < (2 + 1) && !b) return -1;",
        "if (a < 2 && !b) return -(1 + 1);",
        'x[3] -= 2.5 * g("a + b");',
        'x[3] += 2.5 / g("a + b");',
        'x[(3 + 1)] += 2.5 * g("a + b");',
        'x[3] += (2 * 2.5) * g("a + b");',
        "g(a, false);",
        ";",
    }


def test_a_seed_draws_the_same_faults_of_the_files_asked_for():
    """And every one of them can be read; figures have none."""
    faults = drawn("*/bench/*.py", 150, 3)
    assert faults == drawn("*/bench/*.py", 150, 3) != drawn("*/bench/*.py", 150, 4)
    assert {fault.file.split("/")[-2] for fault in faults} == {"bench"} and len({str(f) for f in faults}) > 140
    for fault in faults:
        assert ast.dump(ast.parse(fault.changed)) != ast.dump(ast.parse(fault.text)), str(fault)

    assert drawn("*/plot.py", 10, 1) == []
