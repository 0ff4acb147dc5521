#!/usr/bin/python3
"""Checks that dependencies point down: which folder's files may include what.

usage: check.py TREE

Prints each include that a rule forbids, as file:line, and leaves with 1 if there are any. A folder
without a rule is an error too: a new part says where it belongs.
"""
import pathlib
import re
import sys

# The folder with the longest matching name decides. Names from the top of the tree.
ALLOWED = {
    "processing": ["processing/"],
    "drivers/digitiser": ["processing/base/", "drivers/digitiser/", "drivers/iio/", "drivers/replay/"],
    "drivers/files": ["processing/base/", "processing/bridge/", "drivers/files/"],
    "drivers/iio": ["processing/base/", "drivers/digitiser/", "drivers/iio/"],
    "drivers/memory": ["drivers/memory/"],
    "drivers/replay": ["processing/base/", "drivers/digitiser/", "drivers/files/", "drivers/replay/"],
    "drivers/simulated": ["processing/base/", "processing/impact/", "drivers/files/", "drivers/simulated/"],
    "proto": ["processing/base/", "processing/reduction/", "proto/", "kolsky/v1/"],
    "daemon": ["processing/", "drivers/digitiser/", "drivers/files/", "drivers/memory/", "proto/", "kolsky/v1/", "daemon/"],
    "clients": ["processing/", "drivers/files/", "drivers/memory/", "proto/", "kolsky/v1/", "clients/"],
    "tests": [""],
}

# Within these folders a part may include those named before it.
LAYERS = {
    "processing": "base algebra trigger bridge waves separation impact models reduction identification "
    "criticism specimen uncertainty planning calibration prediction".split(),
    "processing/criticism": "records noise fitting search verdict impact comparing selftest experiment waterfall".split(),
    "drivers/files": "settings models captures store exports tables".split(),
    "clients/cli": "reports live commands".split(),
}

# Results leave through the exports: they know what a reduction holds, and link no more than that.
# The tour shows a simulated campaign.
EXCEPTIONS = {
    "clients/cli/commands/tour": ["drivers/simulated/hidden_campaign.hpp"],
    "drivers/files/exports": ["processing/reduction/reduction.hpp"],
    "drivers/files/models/diagnosis_step": [
        "processing/criticism/search/search_trials.hpp",
        "processing/criticism/verdict/diagnosis.hpp",
    ],
    "drivers/files/models/model_file": ["processing/models/model.hpp"],
    "drivers/files/models/model_expressions": [
        "processing/models/admission.hpp",
        "processing/models/model.hpp",
    ],
}

# processing is pure: no files, no sockets, no clocks, no threads of its own.
IMPURE = re.compile(
    r"(fstream|iostream|filesystem|chrono|ctime|time\.h|thread|condition_variable|future|csignal|"
    r"signal\.h|unistd\.h|fcntl\.h|sys/.*|zmq.*|iio\.h|hdf5.*|H5.*|sqlite3\.h|spdlog/.*|"
    r"toml.*|google/.*|CLI/.*)"
)
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def rule_of(path):
    """The allowed prefixes of the folder a file is in, or None."""
    folder = path.parent
    while str(folder) != ".":
        if str(folder) in ALLOWED:
            return ALLOWED[str(folder)]
        folder = folder.parent
    return None


def points_up(path, name):
    """Whether a layer includes one that is named after it."""
    for folder, layers in LAYERS.items():
        own, other = (part_below(folder, each) for each in (path, pathlib.PurePath(name)))
        if own in layers and other in layers and layers.index(other) > layers.index(own):
            return True
    return False


def part_below(folder, path):
    top = pathlib.PurePath(folder)
    return path.relative_to(top).parts[0] if path.is_relative_to(top) else None


def permitted(path, name, allowed):
    exceptions = [
        extra
        for prefix, extras in EXCEPTIONS.items()
        if str(path).startswith(prefix)
        for extra in extras
    ]
    return any(name.startswith(prefix) for prefix in allowed) or name in exceptions


def problems_of(tree, path):
    allowed = rule_of(path)
    if allowed is None:
        yield f"{path}: no rule says what files of {path.parent} may include"
        return
    for number, line in enumerate((tree / path).read_text().splitlines(), 1):
        found = INCLUDE.match(line)
        if not found:
            continue
        quoted, name = found.group(1) == '"', found.group(2)
        if quoted and not permitted(path, name, allowed):
            yield f"{path}:{number}: includes {name}, and may include {', '.join(allowed)}"
        if quoted and points_up(path, name):
            yield f"{path}:{number}: includes {name}, which stands above it"
        if not quoted and path.parts[0] == "processing" and IMPURE.fullmatch(name):
            yield f"{path}:{number}: includes <{name}>, and processing is pure"


def sources(tree):
    for top in sorted({pathlib.PurePath(name).parts[0] for name in ALLOWED}):
        for path in sorted((tree / top).rglob("*")):
            if path.suffix in {".hpp", ".cpp", ".h"} and "layering" not in path.relative_to(tree).parts:
                yield path.relative_to(tree)


def main():
    tree = pathlib.Path(sys.argv[1])
    files = list(sources(tree))
    problems = [problem for path in files for problem in problems_of(tree, path)]
    for problem in problems:
        print(problem)
    print(f"{len(files)} files, {len(problems)} includes that point the wrong way")
    return 1 if problems or not files else 0


if __name__ == "__main__":
    sys.exit(main())
