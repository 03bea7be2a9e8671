// Every key of a study's file with unit, default, what is allowed and what it means, as
// problems/setting_list.hpp has them of problems and designs.
#pragma once

#include <vector>

#include "problems/config/setting_list.hpp"

namespace armwright {

std::vector<Setting> list_study_settings();

}  // namespace armwright
