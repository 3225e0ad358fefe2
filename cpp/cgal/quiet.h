// CGAL reports failed checks on stderr before it throws. Every operation here begins with this: only the exception
// remains.
#pragma once

namespace softfold::cgal {
void quiet();
}
