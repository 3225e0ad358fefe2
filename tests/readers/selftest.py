"""Plants good and faulty files and asks the readers: a reader that cannot see a fault proves nothing.

    python selftest.py

Prints one JSON object {"checks": N, "failed": [what...]}; exit status 1 when something failed.
"""

import json
import pathlib
import sys
import tempfile

import ezdxf
import lib3mf
import trimesh
from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.gp import gp_Pnt
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.XCAFDoc import XCAFDoc_DocumentTool

import dxf
import figures
import mesh
import step

FAILED, CHECKS = [], []


def expect(what, condition):
    CHECKS.append(what)
    if not condition:
        FAILED.append(what)


def close(a, b):
    return abs(a - b) <= 1e-9 * abs(b)


def write_step(path, shape, name, unit="MM"):
    STEPCAFControl_Controller.Init_s()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    label = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).AddShape(shape, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    writer.Transfer(document)
    writer.Write(str(path))
    return step.facts(str(path))


def check_step(folder):
    box = BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape()
    far = BRepPrimAPI_MakeBox(gp_Pnt(100, 0, 0), 10.0, 10.0, 10.0).Shape()

    good = write_step(folder / "good.step", box, "board")
    expect("step: one product", len(good.get("products", [])) == 1)
    product = good["products"][0]
    expect("step: name", product["name"] == "board")
    expect("step: millimetre", [u.lower() for u in good["units"]] == ["millimetre"])
    expect("step: one valid closed solid",
           len(product["solids"]) == 1 and product["solids"][0]["valid"] and product["solids"][0]["closed"])
    expect("step: volume", close(product["solids"][0]["volume_mm3"], 6000.0))
    expect("step: size", all(close(a, b) for a, b in zip(product["size_mm"], [10, 20, 30])))

    inch = write_step(folder / "inch.step", box, "board", "INCH")
    expect("step: inches are told", [u.lower() for u in inch["units"]] == ["inch"])
    two = write_step(folder / "two.step", BRepAlgoAPI_Fuse(box, far).Shape(), "board")
    expect("step: two solids are told", sum(len(p["solids"]) for p in two["products"]) == 2)
    lone = write_step(folder / "face.step", TopExp_Explorer(box, TopAbs_FACE).Current(), "sheet")
    expect("step: a face is no solid", sum(len(p["solids"]) for p in lone["products"]) == 0)
    expect("step: a face is a face", lone["products"][0]["faces"] == 1 and lone["products"][0]["valid"])
    (folder / "junk.step").write_text("ISO-10303-21;\nnonsense\n")
    expect("step: junk is an error", "error" in step.facts(str(folder / "junk.step")))
    # Losing one face of the closed shell, in the text of the file.
    text = (folder / "good.step").read_text()
    start = text.index("CLOSED_SHELL('',(") + len("CLOSED_SHELL('',(")
    (folder / "open.step").write_text(text[:start] + text[text.index(",", start) + 1:])
    facts = step.facts(str(folder / "open.step"))
    solids = [s for p in facts.get("products", []) for s in p["solids"]]
    expect("step: an open shell is told", not solids or not all(s["valid"] and s["closed"] for s in solids))


def write_3mf(path, body, name, unit=lib3mf.ModelUnit.MilliMeter):
    model = lib3mf.Wrapper().CreateModel()
    model.SetUnit(unit)
    item = model.AddMeshObject()
    item.SetName(name)
    item.SetGeometry([lib3mf.Position((lib3mf.ctypes.c_float * 3)(*map(float, v))) for v in body.vertices],
                     [lib3mf.Triangle((lib3mf.ctypes.c_uint32 * 3)(*map(int, t))) for t in body.faces])
    model.AddBuildItem(item, lib3mf.Wrapper().GetIdentityTransform())
    model.QueryWriter("3mf").WriteToFile(str(path))
    return mesh.facts(str(path))


def check_mesh(folder):
    box = trimesh.creation.box((10, 20, 30))
    holed = trimesh.Trimesh(box.vertices, box.faces[:-1], process=False)
    flipped = box.copy()
    flipped.faces[0] = flipped.faces[0][::-1]
    pair = trimesh.util.concatenate([box, box.copy().apply_translation((100, 0, 0))])

    def stl(name, body):
        body.export(folder / name)
        return mesh.facts(str(folder / name))["meshes"][0]

    good = stl("good.stl", box)
    expect("stl: closed manifold", good["watertight"] and good["manifold"] and good["winding_consistent"])
    expect("stl: volume", close(good["volume_mm3"], 6000.0) and close(good["manifold_volume_mm3"], 6000.0))
    expect("stl: one body", good["bodies"] == 1)
    holed_facts = stl("holed.stl", holed)
    expect("stl: a hole is told", not holed_facts["watertight"] and not holed_facts["manifold"])
    flipped_facts = stl("flipped.stl", flipped)
    expect("stl: a flipped triangle is told", not flipped_facts["winding_consistent"])
    expect("stl: two bodies are told", stl("pair.stl", pair)["bodies"] == 2)
    inside_out = stl("inverted.stl", trimesh.Trimesh(box.vertices, box.faces[:, ::-1], process=False))
    expect("stl: inside out is told", inside_out["volume_mm3"] < 0)
    (folder / "junk.stl").write_text("solid nothing")
    junk = mesh.facts(str(folder / "junk.stl"))
    expect("stl: junk is no solid", "error" in junk or not junk["meshes"] or not junk["meshes"][0]["manifold"])

    part = write_3mf(folder / "good.3mf", box, "A1")
    expect("3mf: name, unit, item", "error" not in part and part["meshes"][0]["name"] == "A1"
           and part["units"] == "MilliMeter" and part["build_items"] == 1)
    expect("3mf: volume", close(part["meshes"][0]["volume_mm3"], 6000.0) and part["meshes"][0]["lib3mf_manifold"])
    expect("3mf: inches are told",
           write_3mf(folder / "inch.3mf", box, "A1", lib3mf.ModelUnit.Inch)["units"] == "Inch")
    open_part = write_3mf(folder / "open.3mf", holed, "A1")
    expect("3mf: a hole is told", "error" in open_part or not open_part["meshes"][0]["lib3mf_manifold"])
    (folder / "junk.3mf").write_bytes(b"PK nothing")
    expect("3mf: junk is an error", "error" in mesh.facts(str(folder / "junk.3mf")))


def check_figures(folder):
    def write(name, values, faces="3 0 1 2\n"):
        corners = [(0, 0, 0), (4, 0, 0), (0, 3, 0)]
        lines = "".join(f"{x} {y} {z} {r} 0 0 {f}\n" for (x, y, z), r, f in zip(corners, (255, 9, 0), values))
        (folder / name).write_text(
            "ply\nformat ascii 1.0\nelement vertex 3\n"
            + "".join(f"property float {axis}\n" for axis in "xyz")
            + "".join(f"property uchar {colour}\n" for colour in ("red", "green", "blue"))
            + f"property float distance\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n{lines}{faces}")
        return figures.facts(str(folder / name))

    good = write("good.ply", (-0.5, 0.25, 1))
    distance = good["figures"]["distance"]
    expect("figures: ends", (distance["min"], distance["max"], distance["mean"]) == (-0.5, 1.0, 0.25))
    expect("figures: nothing else is a figure", list(good["figures"]) == ["distance"])
    expect("figures: mesh and colours", good["colours"] and good["vertices"] == 3 and close(good["area_mm2"], 6.0))
    expect("figures: what is no number is told", not write("nan.ply", (0, "nan", 1))["figures"]["distance"]["finite"])
    (folder / "junk.ply").write_text("ply\nnothing")
    expect("figures: junk is an error", "error" in figures.facts(str(folder / "junk.ply")))


def write_dxf(path, contours, unit=4):
    document = ezdxf.new("R2000")
    document.header["$INSUNITS"] = unit
    document.layers.add("CUT", color=1)
    for points, closed in contours:
        document.modelspace().add_lwpolyline(points, close=closed, dxfattribs={"layer": "CUT"})
    document.modelspace().add_text("A1", dxfattribs={"layer": "TEXT"})
    document.saveas(path)
    return dxf.facts(str(path))


def check_dxf(folder):
    def square(x, y, a):
        return [(x, y), (x + a, y), (x + a, y + a), (x, y + a)]

    good = write_dxf(folder / "good.dxf", [(square(0, 0, 100), True), (square(20, 20, 10), True)])
    cut = good["layers"]["CUT"]
    expect("dxf: clean", not good["errors"] and not good["fixes"] and good["insunits"] == 4)
    expect("dxf: contours", cut["closed"] == 2 and cut["open"] == 0 and not cut["crossing"] and not good["twice"])
    expect("dxf: length", close(cut["length_mm"], 440.0))
    expect("dxf: text", good["layers"]["TEXT"]["texts"] == ["A1"])
    reversed_twin = square(0, 0, 100)[::-1]
    twice = write_dxf(folder / "twice.dxf", [(square(0, 0, 100), True), (reversed_twin, True)])
    expect("dxf: a line drawn twice is told", twice["twice"] == 4)
    overlap = write_dxf(folder / "overlap.dxf", [(square(0, 0, 100), True), (square(90, 50, 100), True)])
    expect("dxf: overlapping parts are told", len(overlap["layers"]["CUT"]["crossing"]) == 1)
    opened = write_dxf(folder / "open.dxf", [(square(0, 0, 100), False)])
    expect("dxf: an open contour is told", opened["layers"]["CUT"]["open"] == 1)
    bow = write_dxf(folder / "bow.dxf", [([(0, 0), (100, 100), (100, 0), (0, 100)], True)])
    expect("dxf: a contour across itself is told", bow["layers"]["CUT"]["self_crossing"] == 1)
    expect("dxf: inches are told", write_dxf(folder / "inch.dxf", [], 1)["insunits"] == 1)
    text = (folder / "good.dxf").read_text()
    (folder / "layerless.dxf").write_text(text[: len(text) // 2])
    torn = dxf.facts(str(folder / "layerless.dxf"))
    expect("dxf: a torn file is told", "error" in torn or torn["errors"] or torn["fixes"] or not torn["layers"])


if __name__ == "__main__":
    from OCP.Message import Message

    Message.DefaultMessenger_s().ChangePrinters().Clear()
    with tempfile.TemporaryDirectory() as name:
        for check in (check_step, check_mesh, check_figures, check_dxf):
            check(pathlib.Path(name))
    json.dump({"checks": len(CHECKS), "failed": FAILED}, sys.stdout, indent=1)
    sys.exit(1 if FAILED else 0)
