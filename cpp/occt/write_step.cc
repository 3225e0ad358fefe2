#include "occt/write_step.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <XSControl_WorkSession.hxx>

#include <stdexcept>
#include <string>

#include "occt/messages.h"
#include "occt/step_document.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

void set_parameter(const char* name, const std::string& value) {
  if (!Interface_Static::SetCVal(name, value.c_str()))
    throw std::runtime_error("OpenCascade does not take " + std::string(name) + " = " + value);
}

// These are process-wide, so each file sets them all.
void set_parameters(const StepHeader& header) {
  set_parameter("write.step.schema", std::string(header.schema));
  set_parameter("write.step.unit", "MM");
  set_parameter("write.step.product.name", std::string(header.product));
  Interface_Static::SetIVal("write.step.assembly", 2);  // 2: only where there is one
}

Handle(TCollection_HAsciiString) text(const rust::String& value) {
  return new TCollection_HAsciiString(std::string(value).c_str());
}

void fill_header(const Handle(StepData_StepModel) & model, const StepHeader& header) {
  APIHeaderSection_MakeHeader section(model);
  section.SetName(text(header.product));
  section.SetTimeStamp(text(header.time_stamp));
  section.SetAuthorValue(1, text(header.author));
  section.SetOrganizationValue(1, text(header.organization));
  section.SetOriginatingSystem(text(header.system));
}

}  // namespace

void write_step(rust::Str path, const rust::Vec<StepPart>& parts, const StepHeader& header) {
  take_messages();
  set_parameters(header);
  StepDocument file;
  STEPCAFControl_Writer writer;
  writer.SetColorMode(Standard_True);
  writer.SetNameMode(Standard_True);
  // One by one: of several parts together, OpenCascade writes the colours in the order of addresses in memory.
  for (const StepPart& part : parts) {
    // With each part the materials of all before it are written once more: so only with the last.
    writer.SetMaterialMode(&part == &parts.back());
    if (!writer.Transfer(file.add(part), STEPControl_AsIs))
      throw std::runtime_error("part " + std::string(part.name) + " does not go into STEP: " + take_messages());
  }
  fill_header(Handle(StepData_StepModel)::DownCast(writer.Writer().WS()->Model()), header);
  if (writer.Write(std::string(path).c_str()) != IFSelect_RetDone)
    throw std::runtime_error("the file cannot be written: " + take_messages());
}

}  // namespace softfold::occt
