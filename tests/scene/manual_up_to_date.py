#!/usr/bin/python3
"""The parameter manual in the repository is what the program prints. Usage: manual_up_to_date.py STIRSPH MANUAL"""

import difflib
import subprocess
import sys
from pathlib import Path


def main():
    program, path = sys.argv[1], Path(sys.argv[2])
    printed = subprocess.run([program, "manual"], capture_output=True, text=True, timeout=50, check=True).stdout
    kept = path.read_text(encoding="utf-8") if path.exists() else ""
    if printed == kept:
        print(f"{path.name} is up to date")
        return 0
    sys.stdout.writelines(difflib.unified_diff(kept.splitlines(True), printed.splitlines(True), str(path), "stirsph manual", n=1))
    print(f"{path} is out of date. Write it anew: {program} manual > {path}")
    return 1


if __name__ == "__main__":
    sys.exit(main())
