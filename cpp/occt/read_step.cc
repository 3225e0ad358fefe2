#include "occt/read_step.h"

#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <TCollection_AsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include <stdexcept>
#include <string>

#include "occt/messages.h"
#include "occt/shape.h"
#include "occt/step_document.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

rust::String name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  const TCollection_AsciiString utf8(name->Get());
  return rust::String::lossy(std::string(utf8.ToCString(), utf8.Length()));
}

// Negative where the file has none.
std::array<float, 3> color_of(const TDF_Label& label) {
  const Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(label);
  Quantity_Color color;
  for (const auto type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen}) {
    if (!colors->GetColor(label, type, color)) continue;
    double red, green, blue;
    color.Values(red, green, blue, Quantity_TOC_sRGB);
    return {static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)};
  }
  return {-1.0F, -1.0F, -1.0F};
}

// Takes assemblies apart. `place` is where the label lies in the whole.
void collect(const TDF_Label& label, const TopLoc_Location& place, rust::Vec<StepPart>& parts) {
  TDF_LabelSequence components;
  if (XCAFDoc_ShapeTool::IsAssembly(label) && XCAFDoc_ShapeTool::GetComponents(label, components)) {
    for (const TDF_Label& component : components) {
      TDF_Label part;
      if (XCAFDoc_ShapeTool::GetReferredShape(component, part))
        collect(part, place * XCAFDoc_ShapeTool::GetLocation(component), parts);
    }
    return;
  }
  const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
  parts.push_back(StepPart{name_of(label), color_of(label), wrap(shape.Moved(place))});
}

}  // namespace

rust::Vec<StepPart> read_step(rust::Str path) {
  take_messages();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  StepDocument file;
  STEPCAFControl_Reader reader;
  reader.SetColorMode(Standard_True);
  reader.SetNameMode(Standard_True);
  if (reader.ReadFile(std::string(path).c_str()) != IFSelect_RetDone)
    throw std::runtime_error("this is no STEP file OpenCascade can read: " + take_messages());
  if (!reader.Transfer(file.document)) throw std::runtime_error("nothing in it is a shape: " + take_messages());
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(file.document->Main())->GetFreeShapes(labels);
  rust::Vec<StepPart> parts;
  for (const TDF_Label& label : labels) collect(label, TopLoc_Location(), parts);
  if (parts.empty()) throw std::runtime_error("the file has no shapes");
  return parts;
}

}  // namespace softfold::occt
