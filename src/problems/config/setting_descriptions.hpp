// What the keys of problems and designs mean, a line each (setting_list.hpp).
#pragma once

#include <vector>

#include "problems/config/setting_list.hpp"

namespace armwright {

const std::vector<SettingWords>& problem_setting_words();
const std::vector<SettingWords>& design_setting_words();

}  // namespace armwright
