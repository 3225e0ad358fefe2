#include "occt/read_step.h"

#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>

#include <stdexcept>
#include <string>

#include "occt/messages.h"
#include "occt/step_document.h"
#include "softfold-kernel/src/bridge/occt.rs.h"

namespace softfold::occt {
rust::Vec<StepPart> read_step(rust::Str path) {
  take_messages();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  StepDocument file;
  STEPCAFControl_Reader reader;
  reader.SetColorMode(Standard_True);
  reader.SetNameMode(Standard_True);
  reader.SetMatMode(Standard_True);
  if (reader.ReadFile(std::string(path).c_str()) != IFSelect_RetDone)
    throw std::runtime_error("this is no STEP file OpenCascade can read: " + take_messages());
  if (!reader.Transfer(file.document)) throw std::runtime_error("nothing in it is a shape: " + take_messages());
  return file.parts();
}

}  // namespace softfold::occt
