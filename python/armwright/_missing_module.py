"""Says why the compiled part of the package cannot be imported, and how to build it."""

from __future__ import annotations

from pathlib import Path


def explain(error: ImportError) -> str:
    """Returns the message for a failed import of the compiled module."""
    folder = Path(__file__).absolute().parent
    if any(folder.glob("_armwright*.so")):
        return f"{folder}: the compiled module _armwright is there, but cannot be loaded: {error}"
    build = folder.parents[1]
    command = (f"cmake --build {build} --target _armwright" if (build / "CMakeCache.txt").is_file() else
               "cmake --build --preset release --target _armwright, in the source folder of armwright, with PYTHONPATH=build/release/python")
    return f"{folder}: the compiled module _armwright is missing, because the Python package has not been built. Build it: {command}"
