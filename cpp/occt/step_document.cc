#include "occt/step_document.h"

#include <Quantity_Color.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDataStd_TreeNode.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include <stdexcept>
#include <string>

#include "occt/shape.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

constexpr double meters_per_unit = 0.001;

Handle(TCollection_HAsciiString) text(const std::string& value) { return new TCollection_HAsciiString(value.c_str()); }

// XCAF has densities in g/cm³, whatever the unit of length.
void set_material(const TDF_Label& label, const StepPart& part) {
  if (part.material.empty()) return;
  XCAFDoc_DocumentTool::MaterialTool(label)->SetMaterial(label, text(std::string(part.material)), text(""),
                                                         part.density_g_cm3, text("density measure"),
                                                         text("POSITIVE_RATIO_MEASURE"));
}

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

void read_material(const TDF_Label& label, StepPart& part) {
  Handle(TDataStd_TreeNode) node;
  if (!label.FindAttribute(XCAFDoc::MaterialRefGUID(), node) || !node->HasFather()) return;
  Handle(TCollection_HAsciiString) name, description, density_name, density_type;
  double density = 0.0;
  if (!XCAFDoc_DocumentTool::MaterialTool(label)->GetMaterial(node->Father()->Label(), name, description, density,
                                                             density_name, density_type))
    return;
  if (!name.IsNull()) part.material = rust::String::lossy(name->ToCString());
  part.density_g_cm3 = density;
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
  StepPart part{name_of(label), color_of(label), {}, 0.0, wrap(shape.Moved(place))};
  read_material(label, part);
  parts.push_back(std::move(part));
}

}  // namespace

StepDocument::StepDocument() {
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  XCAFDoc_DocumentTool::SetLengthUnit(document, meters_per_unit);
}

StepDocument::~StepDocument() {
  try {
    XCAFApp_Application::GetApplication()->Close(document);
  } catch (...) {
    // A document that will not close is only memory; what leaves a destructor ends the process.
  }
}

TDF_Label StepDocument::add(const StepPart& part) {
  const TDF_Label label = XCAFDoc_DocumentTool::ShapeTool(document->Main())->AddShape(*part.shape, Standard_False);
  TDataStd_Name::Set(label, TCollection_ExtendedString(std::string(part.name).c_str(), Standard_True));
  const Quantity_Color color(part.color[0], part.color[1], part.color[2], Quantity_TOC_sRGB);
  XCAFDoc_DocumentTool::ColorTool(document->Main())->SetColor(label, color, XCAFDoc_ColorSurf);
  set_material(label, part);
  return label;
}

rust::Vec<StepPart> StepDocument::parts() const {
  TDF_LabelSequence labels;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(labels);
  rust::Vec<StepPart> found;
  for (const TDF_Label& label : labels) collect(label, TopLoc_Location(), found);
  if (found.empty()) throw std::runtime_error("the file has no shapes");
  return found;
}

}  // namespace softfold::occt
