#!/usr/bin/python3
"""Runs every command of a tutorial, in its order, in one empty folder.

usage: run_tutorial.py TUTORIAL.md KOLSKY

Commands are the lines that begin with "$ " in fenced ```console blocks; a line that ends in "\\"
goes on in the next one. What follows a command in its block is its output, "..." for what is left
out: every line of it must be among what the command really printed, its numbers near enough. Leaves
with 1 at the first command that fails, that prints something else, or where there is no command at
all.
"""
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
# Another machine's arithmetic moves a fit by a fraction of its deviation, and a bar by a block.
TOLERANCE = 0.02


def blocks(text):
    return re.findall(r"^```console\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def steps(text):
    """Pairs of a command and the lines that the tutorial shows of its output."""
    found = []
    for block in blocks(text):
        going_on = False
        for line in block.splitlines():
            if going_on:
                found[-1][0] += "\n" + line
            elif line.startswith("$ "):
                found.append([line[2:], []])
            elif found:
                found[-1][1].append(line)
            going_on = line.endswith("\\") and (going_on or line.startswith("$ "))
    return found


def run(command, folder, kolsky):
    environment = dict(os.environ, PATH=f"{kolsky.parent}:{os.environ['PATH']}")
    return subprocess.run(["/bin/sh", "-c", command], cwd=folder, env=environment, text=True,
                          capture_output=True, check=False)


def frame_of(line):
    """A line without its numbers, its blanks and how long its bars are."""
    line = re.sub(r"[█░]+", "█", NUMBER.sub("#", line))
    return re.sub(r"\s+", " ", line).strip()


def slack(number):
    """Two of the last digit as written; none for what is counted."""
    mantissa, _, power = number.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 2.0 * 10.0 ** (int(power or 0) - decimals) if decimals or power else 0.0


def agree(shown, printed):
    if frame_of(shown) != frame_of(printed):
        return False
    return all(math.isclose(float(a), float(b), rel_tol=TOLERANCE, abs_tol=slack(a))
               for a, b in zip(NUMBER.findall(shown), NUMBER.findall(printed)))


def problem_of(shown, done):
    if done.returncode != 0:
        return f"exit code {done.returncode}: {done.stderr.strip()}"
    printed = done.stdout.splitlines()
    for line in shown:
        if line.strip() in ("", "..."):
            continue
        if not any(agree(line, own) for own in printed):
            return f"the tutorial shows \"{line}\", and it printed\n{done.stdout}"
    return None


def main():
    tutorial, kolsky = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    todo = steps(tutorial.read_text())
    with tempfile.TemporaryDirectory() as folder:
        folder_now = folder
        for number, (command, shown) in enumerate(todo, 1):
            if command.startswith("cd "):
                folder_now = pathlib.Path(folder_now, command[3:])
                continue
            problem = problem_of(shown, run(command, folder_now, kolsky))
            if problem:
                print(f"{tutorial}: command {number}: {command}\n{problem}")
                return 1
    print(f"{len(todo)} commands ran")
    return 0 if todo else 1


if __name__ == "__main__":
    sys.exit(main())
