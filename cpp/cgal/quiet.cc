#include "cgal/quiet.h"

#include <CGAL/assertions.h>
#include <CGAL/assertions_behaviour.h>

namespace softfold::cgal {
namespace {
void ignore(const char*, const char*, const char*, int, const char*) {}
}  // namespace

void quiet() {
  static const bool once = [] {
    CGAL::set_error_handler(ignore);
    CGAL::set_warning_handler(ignore);
    return true;
  }();
  static_cast<void>(once);
}
}  // namespace softfold::cgal
