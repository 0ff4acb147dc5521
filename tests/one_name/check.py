#!/usr/bin/python3
"""Checks that one name is one type: no two files define types of the same full name.

usage: check.py TREE

Linked into one program, two such types share what the compiler makes of them out of line: one's
objects are destroyed by the other's destructor, and neither compiler nor linker says so. Prints
each name with the places that define it, and leaves with 1 if there are any. Types in unnamed
namespaces are a file's own.
"""
import collections
import pathlib
import re
import sys

FOLDERS = ["processing", "drivers", "proto", "daemon", "clients", "tests"]

NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'
    r"(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])*'",
    re.DOTALL,
)
# A type's name is followed by its bases or its body; `struct Of::Another {` is of another's scope.
BRACE = re.compile(
    r"\bnamespace\s+(?P<space>[\w:]*)\s*\{|"
    r"\b(?:struct|class|union|enum(?:\s+(?:class|struct))?)\s+(?:\[\[\w+\]\]\s*)?"
    r"(?P<type>\w+)(?!\w|\s*::)\s*(?:final\s*)?(?::[^;{}()]*)?\{|"
    r"\bnamespace\s*\{|(?P<open>\{)|(?P<close>\})"
)


def types_of(text):
    """Full names of the types that a file defines in named namespaces, each with its line."""
    code = NOT_CODE.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)
    scopes = []  # names of namespaces; None for whatever makes what is inside a file's or type's own
    for found in BRACE.finditer(code):
        if found["close"]:
            if scopes:
                scopes.pop()
        elif found["type"]:
            if None not in scopes:
                yield "::".join([*scopes, found["type"]]), code.count("\n", 0, found.start()) + 1
            scopes.append(None)
        else:
            scopes.append(found["space"] or None)


def main():
    tree = pathlib.Path(sys.argv[1])
    files = [
        path
        for folder in FOLDERS
        for path in sorted((tree / folder).rglob("*"))
        if path.suffix in {".hpp", ".cpp", ".h"} and "bad" not in path.relative_to(tree).parts
    ]
    places = collections.defaultdict(list)
    for path in files:
        for name, line in types_of(path.read_text(encoding="utf-8")):
            places[name].append(f"{path.relative_to(tree)}:{line}")
    twice = {name: where for name, where in sorted(places.items()) if len(where) > 1}
    for name, where in twice.items():
        print(f"{name} is defined in {' and '.join(where)}: give each thing a name of its own")
    print(f"{len(places)} types, {len(twice)} names of more than one")
    return 1 if twice or not places else 0


if __name__ == "__main__":
    sys.exit(main())
