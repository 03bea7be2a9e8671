// Values in the form of the pages' JSON (web/src/data.ts): SI units, and null for a number without
// a value. Only .cpp files include this.
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "problems/interface/problem.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {

inline nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}
inline nlohmann::json finite_or_null(const std::optional<double>& value) {
  return value ? finite_or_null(*value) : nlohmann::json(nullptr);
}
nlohmann::json finite_or_null(std::span<const double> values);

// Return an array of numbers as Packed of web/src/data.ts: little-endian in base64 (RFC 4648,
// section 4, with padding).
nlohmann::json pack_f32(std::span<const float> values);          // {"f32": ...}
nlohmann::json pack_u32(std::span<const std::uint32_t> values);  // {"u32": ...}

// Returns Quantity. With `own_unit` the page does not convert it, as for a problem without an arm.
nlohmann::json make_quantity(const Quantity& quantity, bool own_unit = false);
nlohmann::json make_fact(std::string_view label, std::string_view value);
// Returns version and commit of the program that makes the page.
nlohmann::json make_program();

// Returns the whole page as text. Bytes that are not UTF-8 are replaced.
std::string dump_page(const nlohmann::json& page);

}  // namespace armwright
