// An XCAF document in millimetres that closes itself.
#pragma once

#include <TDocStd_Document.hxx>

namespace softfold::occt {

class StepDocument {
public:
  StepDocument();
  ~StepDocument();
  StepDocument(const StepDocument&) = delete;
  StepDocument& operator=(const StepDocument&) = delete;

  Handle(TDocStd_Document) document;
};

}  // namespace softfold::occt
