"""Every test that docs/shown-by.md names exists. Argument: the project's folder."""

import pathlib
import re
import sys

NAMED = re.compile(r"`(\.\.\.[A-Z]\w*|[A-Z]\w*\.(?:\*|[A-Z]\w*(?:\.\.\.)?))`")
DEFINED = re.compile(r"\b(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)")


def defined_tests(project):
    for source in (project / "tests").rglob("*.cpp"):
        yield from DEFINED.findall(source.read_text(encoding="utf-8"))


def exists(name, tests):
    if name.startswith("..."):
        return any(test.endswith(name[3:]) for _, test in tests)
    suite, test = name.split(".", 1)
    if test == "*":
        return any(own == suite for own, _ in tests)
    if test.endswith("..."):
        return any(own == suite and other.startswith(test[:-3]) for own, other in tests)
    return (suite, test) in tests


def main():
    project = pathlib.Path(sys.argv[1])
    page = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else project / "docs/shown-by.md"
    tests = set(defined_tests(project))
    named = set(NAMED.findall(page.read_text(encoding="utf-8")))
    missing = sorted(name for name in named if not exists(name, tests))
    for name in missing:
        print(f"{page}: {name} is no test: name the one that shows it now")
    print(f"{len(named)} tests named, {len(missing)} missing")
    return 1 if missing or not named else 0


sys.exit(main())
