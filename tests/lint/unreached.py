#!/usr/bin/python3
"""No statement stands behind one that ends its block: a check after done() never runs, and no test fails. Looked at are
all programs in Python, where done(), verdict.end(), sys.exit(), return, raise, break and continue end a block, and an
if, with or try whose ways all end so; and unit tests in C, behind 'return CHECK_DONE()'. LINT_ROOT: another tree, for a
test of the test."""
import ast
import glob
import os
import re

import verdict

ROOT = os.environ.get("LINT_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
LEAVE = (ast.Return, ast.Raise, ast.Break, ast.Continue)
EXITS = {"done", "runs.done", "verdict.end", "sys.exit"}


def ends(statement):
    """Whether nothing that follows the statement in its block is reached."""
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
        return ast.unparse(statement.value.func) in EXITS
    if isinstance(statement, ast.If):
        return closed(statement.body) and closed(statement.orelse)
    if isinstance(statement, ast.With):
        return closed(statement.body)
    if isinstance(statement, ast.Try):
        ways = [statement.orelse or statement.body] + [handler.body for handler in statement.handlers]
        return closed(statement.finalbody) or all(map(closed, ways))
    return isinstance(statement, LEAVE)


def closed(block):
    return any(map(ends, block))


def unreached(text):
    """(line, its statement) of the first statement in each block that is not reached."""
    for node in ast.walk(ast.parse(text)):
        for name in ("body", "orelse", "finalbody"):
            block = getattr(node, name, None)
            if isinstance(block, list):  # that of a lambda is an expression
                last = next((k for k, statement in enumerate(block) if ends(statement)), len(block))
                yield from ((statement.lineno, ast.unparse(statement)) for statement in block[last + 1:last + 2])


def unreached_c(text):
    """The same of C: what follows 'return CHECK_DONE();' before the end of the function."""
    for match in re.finditer(r"^  return CHECK_DONE\(\);\n+(?!\})(.*)", text, re.M):
        yield text.count("\n", 0, match.start(1)) + 1, match[1].strip()


bad, count = [], 0
for pattern, find in (("**/*.py", unreached), ("tests/unit/*.c", unreached_c)):
    for path in sorted(glob.glob(pattern, root_dir=ROOT, recursive=True)):
        if path.startswith("output/"):
            continue
        with open(os.path.join(ROOT, path), encoding="utf-8") as file:
            found = list(find(file.read()))
        count += 1
        bad += [f"{path}:{line}: '{words.splitlines()[0][:60]}' is never reached" for line, words in found]
verdict.end("unreached", bad, f"{count} programs and unit tests")
