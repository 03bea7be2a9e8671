// The modules of this build. CMake defines their ids for this file alone, so that a change of a
// module compiles little else.

#include "process/module_loader.hpp"

#ifndef ARMWRIGHT_CERES_ID
#define ARMWRIGHT_CERES_ID ""
#endif
#ifndef ARMWRIGHT_PAGMO_ID
#define ARMWRIGHT_PAGMO_ID ""
#endif

namespace armwright {

const Module kCeresModule = {"ceres", ARMWRIGHT_CERES_ID, "Ceres Solver", "ARMWRIGHT_WITH_CERES",
                             "libcholmod3 libcxsparse3 libgoogle-glog0v6 liblapack3"};
const Module kPagmoModule = {"pagmo", ARMWRIGHT_PAGMO_ID, "pagmo", "ARMWRIGHT_WITH_PAGMO",
                             "libpagmo8"};

}  // namespace armwright
