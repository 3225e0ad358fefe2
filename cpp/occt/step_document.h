// An XCAF document in millimetres that closes itself: parts with names, colours and materials, on their way to a file or
// back from one.
#pragma once

#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>

#include "rust/cxx.h"

namespace softfold::occt {

struct StepPart;

class StepDocument {
public:
  StepDocument();
  ~StepDocument();
  StepDocument(const StepDocument&) = delete;
  StepDocument& operator=(const StepDocument&) = delete;

  // The label of a new part.
  TDF_Label add(const StepPart& part);
  // All parts, assemblies taken apart and their parts put in place; throws if there are none.
  rust::Vec<StepPart> parts() const;

  Handle(TDocStd_Document) document;
};

}  // namespace softfold::occt
