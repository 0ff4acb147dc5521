#!/usr/bin/python3
"""Runs every command of a tutorial, in its order, in one empty folder.

usage: run_tutorial.py TUTORIAL.md KOLSKY

Commands are the lines that begin with "$ " in fenced ```console blocks; a line that ends in "\\"
goes on in the next one. What follows a command in its block is its output: lines of it that say a
verdict must be among what the command really printed. Leaves with 1 at the first command that
fails, that says another verdict, or where there is no command at all.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MUST_HOLD = re.compile(r"^(verdict: |  missing: |The truth: )")


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


def problem_of(shown, done):
    if done.returncode != 0:
        return f"exit code {done.returncode}: {done.stderr.strip()}"
    printed = done.stdout.splitlines()
    for line in shown:
        if MUST_HOLD.match(line) and line not in printed:
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
