// Values as the pages' JSON has them (web/src/data.ts): SI units, null for a number that does not
// exist, long arrays packed. Only .cpp files include this.
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "problems/problem.hpp"
#include "study/summary.hpp"

namespace armwright {

// RFC 4648, section 4, with padding.
std::string encode_base64(std::string_view bytes);

// Packed: little-endian numbers in base64.
nlohmann::json packed(std::span<const float> values);
nlohmann::json packed(std::span<const std::uint32_t> values);

inline nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}
inline nlohmann::json finite_or_null(const std::optional<double>& value) {
  return value ? finite_or_null(*value) : nlohmann::json(nullptr);
}
nlohmann::json finite_or_null(std::span<const double> values);

nlohmann::json make_quantity(const Quantity& quantity);
nlohmann::json make_fact(std::string_view label, std::string_view value);
// The program that makes the page.
nlohmann::json make_program();

// A shell command of these words: each stands for itself whatever it holds, and words that need no
// quotes have none.
std::string make_command(std::span<const std::string> words);

// The whole page as text. Text that is no UTF-8 is made so.
std::string dump_page(const nlohmann::json& page);

}  // namespace armwright
