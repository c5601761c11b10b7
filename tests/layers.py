#!/usr/bin/python3
"""Checks that src/ obeys the table of layers: who may include whom, and which folder may use which library.

Usage: tests/layers.py [ROOT] | tests/layers.py --check-itself
"""

import re
import sys
import tempfile
from pathlib import Path

LAYERS = {
    "base": [],
    "input": ["base"],
    "particles": ["base"],
    "geometry": ["base", "input"],
    "materials": ["base", "input"],
    "neighbours": ["base", "particles"],
    "parallel": ["base", "particles"],
    "io": ["base", "particles", "geometry"],
    "mechanics": ["base", "input", "particles", "materials", "neighbours", "parallel"],
    "contact": ["base", "input", "particles", "geometry", "materials"],
    "thermal": ["base", "input", "particles", "geometry", "materials", "neighbours", "parallel"],
    "microstructure": ["base", "input", "particles", "materials"],
}
LAYERS["scene"] = list(LAYERS)
LAYERS["driver"] = list(LAYERS)

# A library is known to one folder only; the others see that folder's own interface.
LIBRARIES = {
    r"petsc": "thermal",
    r"hdf5|H5": "io",
    r"metis": "parallel",
    r"spdlog/": "base",
    r"toml": "input",
    r"udunits": "input",
    r"muParser": "input",
    r"gmsh": "geometry",
}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')


def problems(root):
    """One line per breach: file, line, what is wrong, what is allowed."""
    found = []
    for path in sorted((root / "src").rglob("*.[ch]pp")):
        folder = path.relative_to(root / "src").parts[0]
        where = path.relative_to(root)
        if folder not in LAYERS:
            found.append(f"{where}: the folder {folder} is in no layer; name it in tests/layers.py and CMakeLists.txt")
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            own, library = match.groups()
            if own:
                target = own.split("/")[0] if "/" in own else ""
                if target not in LAYERS:
                    found.append(f'{where}:{number}: "{own}" does not start with a folder of src/')
                elif target != folder and target not in LAYERS[folder]:
                    allowed = ", ".join(LAYERS[folder]) or "nothing"
                    found.append(f"{where}:{number}: {folder} must not include {target} (allowed: {allowed})")
                continue
            for pattern, owner in LIBRARIES.items():
                if re.match(pattern, library) and folder != owner:
                    found.append(f"{where}:{number}: only {owner} may include <{library}>")
    return found


def check_itself():
    """The check must see each kind of breach and nothing else."""
    with tempfile.TemporaryDirectory() as scratch:
        root = Path(scratch)
        for name, text in {
            "base/good.cpp": '#include "base/good.hpp"\n#include <spdlog/spdlog.h>\n#include <vector>\n',
            "io/good.hpp": '#include "particles/set.hpp"\n#include <hdf5.h>\n',
            "base/upward.hpp": '#include "io/good.hpp"\n',
            "particles/library.cpp": "#include <petscksp.h>\n",
            "driver/bare.cpp": '  #  include "good.hpp"\n',
            "newfolder/file.cpp": "\n",
        }.items():
            path = root / "src" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        found = [line.split(":")[0] for line in problems(root)]
        expected = ["src/base/upward.hpp", "src/driver/bare.cpp", "src/newfolder/file.cpp", "src/particles/library.cpp"]
        assert found == expected, found


def main():
    if sys.argv[1:] == ["--check-itself"]:
        check_itself()
        return 0
    found = problems(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent)
    print("\n".join(found) if found else "layers: in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
