#include "occt/iges.h"

#include <IGESCAFControl_Reader.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <TCollection_HAsciiString.hxx>

#include <stdexcept>
#include <string>

#include "occt/messages.h"
#include "occt/step_document.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
namespace {

Handle(TCollection_HAsciiString) text(const rust::String& value) {
  return new TCollection_HAsciiString(std::string(value).c_str());
}

// These are process-wide, so each file sets them all.
void set_parameters(const StepHeader& header) {
  IGESControl_Controller::Init();
  Interface_Static::SetIVal("write.iges.brep.mode", 1);
  Interface_Static::SetCVal("write.iges.unit", "MM");
  Interface_Static::SetCVal("write.iges.header.author", std::string(header.author).c_str());
  Interface_Static::SetCVal("write.iges.header.company", std::string(header.organization).c_str());
  Interface_Static::SetCVal("write.iges.header.product", std::string(header.product).c_str());
}

// OpenCascade puts its own time and the path of the file here; equal parts are to make equal bytes.
void fill_header(const Handle(IGESData_IGESModel) & model, const StepHeader& header) {
  IGESData_GlobalSection section = model->GlobalSection();
  section.SetFileName(text(header.product));
  section.SetSystemId(text(header.system));
  section.SetDate(text(header.time_stamp));
  section.SetLastChangeDate(text(header.time_stamp));
  model->SetGlobalSection(section);
}

}  // namespace

void write_iges(rust::Str path, const rust::Vec<StepPart>& parts, const StepHeader& header) {
  take_messages();
  set_parameters(header);
  StepDocument file;
  IGESCAFControl_Writer writer;
  writer.SetColorMode(Standard_True);
  writer.SetNameMode(Standard_True);
  for (const StepPart& part : parts)
    if (!writer.Transfer(file.add(part)))
      throw std::runtime_error("part " + std::string(part.name) + " does not go into IGES: " + take_messages());
  writer.ComputeModel();
  fill_header(writer.Model(), header);
  if (!writer.Write(std::string(path).c_str()))
    throw std::runtime_error("the file cannot be written: " + take_messages());
}

rust::Vec<StepPart> read_iges(rust::Str path) {
  take_messages();
  IGESControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  StepDocument file;
  IGESCAFControl_Reader reader;
  reader.SetColorMode(Standard_True);
  reader.SetNameMode(Standard_True);
  if (reader.ReadFile(std::string(path).c_str()) != IFSelect_RetDone)
    throw std::runtime_error("this is no IGES file OpenCascade can read: " + take_messages());
  if (!reader.Transfer(file.document)) throw std::runtime_error("nothing in it is a shape: " + take_messages());
  return file.parts();
}

}  // namespace softfold::occt
