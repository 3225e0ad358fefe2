"""What trimesh says of the figures at the vertices of coloured PLY files: one JSON object, file by file, on standard output.

    python figures.py FILE.ply...

Facts only; the caller judges. A file that cannot be read gets the key "error".
"""

import json
import sys

import numpy
import trimesh

PLACES = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"}


def columns(data):
    """The properties of an element as arrays by name; trimesh keeps them as one structured array or as a dictionary."""
    names = data.dtype.names if hasattr(data, "dtype") else data.keys()
    return {name: numpy.asarray(data[name], dtype=float).ravel() for name in names}


def read(path):
    mesh = trimesh.load_mesh(path, process=False)
    if not isinstance(mesh, trimesh.Trimesh):
        raise ValueError(f"holds a {type(mesh).__name__}, no triangle mesh")
    vertex = columns(mesh.metadata["_ply_raw"]["vertex"]["data"])
    figures = {
        name: {
            "min": float(values.min()),
            "max": float(values.max()),
            "mean": float(values.mean()),
            "finite": bool(numpy.isfinite(values).all()),
        }
        for name, values in vertex.items()
        if name not in PLACES
    }
    return {
        "vertices": len(mesh.vertices),
        "triangles": len(mesh.faces),
        "colours": mesh.visual.kind == "vertex",
        "area_mm2": float(mesh.area),
        "figures": figures,
    }


def facts(path):
    try:
        return read(path)
    except Exception as fault:  # whatever a reader throws is a fact about the file
        return {"error": f"{type(fault).__name__}: {fault}"}


if __name__ == "__main__":
    json.dump({path: facts(path) for path in sys.argv[1:]}, sys.stdout, indent=1)
