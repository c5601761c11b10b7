#!/usr/bin/python3
"""Checks that every script is executable, has an interpreter line and parses. Usage: scripts.py ROOT"""

import ast
import os
import subprocess
import sys
from pathlib import Path


def problem_of(path):
    """What is wrong with one script, empty if nothing."""
    first = path.read_text(encoding="utf-8").split("\n", 1)[0]
    if not first.startswith("#!"):
        return "has no interpreter line"
    if not os.access(path, os.X_OK):
        return "is not executable (chmod +x)"
    if "bash" in first:
        result = subprocess.run(["bash", "-n", path], capture_output=True, text=True, check=False)
        return result.stderr.strip()
    if "python" in first:
        try:
            ast.parse(path.read_text(encoding="utf-8"))
        except SyntaxError as error:
            return str(error)
        return ""
    return f"has an interpreter this project does not use: {first}"


def main():
    root = Path(sys.argv[1])
    folders = ["tools", "cluster", ".ci", "tests"]
    scripts = [path for folder in folders for path in (root / folder).rglob("*")
               if path.is_file() and (path.suffix in (".sh", ".py", ".slurm") or path == root / ".ci/run")]
    found = [f"{path.relative_to(root)}: {problem}" for path in sorted(scripts) if (problem := problem_of(path))]
    print("\n".join(found) if found else f"scripts: {len(scripts)} in order")
    return 1 if found or not scripts else 0


if __name__ == "__main__":
    sys.exit(main())
