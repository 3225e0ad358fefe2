"""What OpenCascade 8 says of STEP, IGES and BREP files: one JSON object, file by file, on standard output.

    python step.py FILE.step|iges|brep...

Facts only; the caller judges. A file that cannot be read gets the key "error".
Volumes are by adaptive Gauss-Kronrod: the plain form is wrong on B-spline faces. Lengths are millimetres.
"""

import json
import sys

from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepTools import BRepTools
from OCP.collections import Sequence_TCollection_AsciiString, Sequence_TDF_Label
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.Message import Message
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name, TDataStd_TreeNode
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc, XCAFDoc_DocumentTool, XCAFDoc_Material

VOLUME_EPS = 1e-8  # relative, per face


def parts(shape, kind):
    """All sub-shapes of one kind."""
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def units(path):
    """The length units that the file itself declares; transferring nothing."""
    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        raise ValueError("not a STEP file")
    lengths, angles, solid_angles = (Sequence_TCollection_AsciiString() for _ in range(3))
    reader.FileUnits(lengths, angles, solid_angles)
    return sorted({lengths.Value(i).ToCString() for i in range(1, lengths.Length() + 1)})


def reader(path):
    """The reader of a file's format, with what it is told to look for."""
    if path.endswith((".iges", ".igs")):
        return IGESCAFControl_Reader()
    step = STEPCAFControl_Reader()
    step.SetMatMode(True)
    return step


def material(label):
    """Name and density in kg/m³ of what a part is made of."""
    node, of = TDataStd_TreeNode(), XCAFDoc.MaterialRefGUID_s()
    if not label.IsAttribute(of) or not label.FindAttribute(of, node) or not node.HasFather():
        return None
    found = XCAFDoc_Material()
    if not node.Father().Label().FindAttribute(XCAFDoc_Material.GetID_s(), found):
        return None
    # OpenCascade has densities in g/cm³.
    return {"name": found.GetName().ToCString(), "density_kg_m3": 1000.0 * found.GetDensity()}


def products(path):
    """Named top-level products, their shapes and materials."""
    if path.endswith(".brep"):
        shape = TopoDS_Shape()
        if not BRepTools.Read_s(shape, path, BRep_Builder()):
            raise ValueError("not a BREP file")
        yield None, shape, None
        return
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    file = reader(path)
    file.SetNameMode(True)
    if file.ReadFile(path) != IFSelect_RetDone or not file.Transfer(document):
        raise ValueError("not a file that can be transferred")
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = Sequence_TDF_Label()
    tool.GetFreeShapes(labels)
    for i in range(1, labels.Length() + 1):
        label, name = labels.Value(i), TDataStd_Name()
        found = label.FindAttribute(TDataStd_Name.GetID_s(), name)
        yield (name.Get().ToExtString() if found else None), tool.GetShape_s(label), material(label)


def volume(solid):
    """Volume in mm³ and the relative error that the integration reports."""
    properties = GProp_GProps()
    error = BRepGProp.VolumePropertiesGK_s(solid, properties, VOLUME_EPS, True, True, True)
    return properties.Mass(), error


def facts_of_solid(solid):
    mass, error = volume(solid)
    shells = list(parts(solid, TopAbs_SHELL))
    return {
        "valid": BRepCheck_Analyzer(solid).IsValid(),
        "closed": all(BRep_Tool.IsClosed_s(shell) for shell in shells),
        "shells": len(shells),
        "faces": len(list(parts(solid, TopAbs_FACE))),
        "volume_mm3": mass,
        "volume_error": error,
    }


def facts_of_product(name, shape, made_of):
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return {
        "name": name,
        "material": made_of,
        "valid": BRepCheck_Analyzer(shape).IsValid(),
        "faces": len(list(parts(shape, TopAbs_FACE))),
        "size_mm": [high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z()],
        "solids": [facts_of_solid(solid) for solid in parts(shape, TopAbs_SOLID)],
    }


def facts(path):
    try:
        declared = [] if path.endswith((".iges", ".igs", ".brep")) else units(path)
        return {"units": declared, "products": [facts_of_product(*p) for p in products(path)]}
    except Exception as fault:  # whatever a reader throws is a fact about the file
        return {"error": f"{type(fault).__name__}: {fault}"}


def main():
    Message.DefaultMessenger_s().ChangePrinters().Clear()  # nothing but JSON on standard output
    json.dump({path: facts(path) for path in sys.argv[1:]}, sys.stdout, indent=1)


if __name__ == "__main__":
    main()
