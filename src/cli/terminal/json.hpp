// JSON of what may not exist.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace armwright {

// null for what does not exist; never NaN, which JSON does not know.
inline nlohmann::json to_json_value(std::optional<double> value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

}  // namespace armwright
