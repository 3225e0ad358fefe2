#include "occt/step_document.h"

#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>

namespace softfold::occt {
namespace {
constexpr double meters_per_unit = 0.001;
}

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

}  // namespace softfold::occt
