"""What trimesh, manifold3d and lib3mf say of mesh files: one JSON object, file by file, on standard output.

    python mesh.py FILE.stl|FILE.3mf|FILE.obj|FILE.ply...

Facts only; the caller judges. A file that cannot be read gets the key "error".
STL, OBJ and PLY are read by trimesh, 3MF by lib3mf; each mesh then goes through trimesh and manifold3d.
"""

import json
import pathlib
import sys

import lib3mf
import manifold3d
import numpy
import trimesh


def facts_of_mesh(name, vertices, triangles, colours=False):
    """Facts of one mesh; vertices at the same place are one vertex (STL knows no other sharing)."""
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices(digits_vertex=9)
    solid = manifold3d.Manifold(manifold3d.Mesh64(
        vert_properties=numpy.asarray(mesh.vertices, dtype=numpy.float64),
        tri_verts=numpy.asarray(mesh.faces, dtype=numpy.uint64)))
    manifold = str(solid.status()).rsplit(".", 1)[-1] == "NoError" and not solid.is_empty()
    return {
        "name": name,
        "vertices": len(mesh.vertices),
        "triangles": len(mesh.faces),
        "watertight": bool(mesh.is_watertight),
        "winding_consistent": bool(mesh.is_winding_consistent),
        "manifold": manifold,
        "bodies": len(solid.decompose()) if manifold else None,
        "volume_mm3": float(mesh.volume),
        "manifold_volume_mm3": solid.volume() if manifold else None,
        "area_mm2": float(mesh.area),
        "size_mm": [float(x) for x in mesh.extents] if len(mesh.faces) else [0.0, 0.0, 0.0],
        "finite": bool(numpy.isfinite(mesh.vertices).all()),
        "colours": colours,
    }


def read_by_trimesh(path):
    mesh = trimesh.load_mesh(path, process=False)
    if not isinstance(mesh, trimesh.Trimesh):
        raise ValueError(f"holds a {type(mesh).__name__}, no triangle mesh")
    colours = mesh.visual.kind == "vertex"
    return {"units": None, "meshes": [facts_of_mesh(None, mesh.vertices, mesh.faces, colours)]}


def read_by_lib3mf(path):
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(path)
    meshes, objects = [], model.GetMeshObjects()
    while objects.MoveNext():
        item = objects.GetCurrentMeshObject()
        vertices = numpy.array([list(v.Coordinates) for v in item.GetVertices()], dtype=float).reshape(-1, 3)
        triangles = numpy.array([list(t.Indices) for t in item.GetTriangleIndices()], dtype=int).reshape(-1, 3)
        facts = facts_of_mesh(item.GetName(), vertices, triangles)
        facts["lib3mf_manifold"] = bool(item.IsManifoldAndOriented())
        meshes.append(facts)
    warnings = [reader.GetWarning(i)[1] for i in range(reader.GetWarningCount())]
    items, built = model.GetBuildItems(), 0
    while items.MoveNext():
        built += 1
    unit = model.GetUnit()
    return {
        "units": getattr(unit, "name", str(unit)),
        "meshes": meshes,
        "build_items": built,
        "warnings": warnings,
    }


def facts(path):
    try:
        return read_by_lib3mf(path) if pathlib.Path(path).suffix.lower() == ".3mf" else read_by_trimesh(path)
    except Exception as fault:  # whatever a reader throws is a fact about the file
        return {"error": f"{type(fault).__name__}: {fault}"}


if __name__ == "__main__":
    json.dump({path: facts(path) for path in sys.argv[1:]}, sys.stdout, indent=1)
