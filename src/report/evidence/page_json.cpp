#include "report/evidence/page_json.hpp"

#include <bit>
#include <vector>

#include "base/base64.hpp"
#include "base/build_info.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Packs in little-endian order on every machine.
template <typename Number>
std::string pack(std::span<const Number> values) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * values.size());
  for (const Number value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  return to_base64(bytes);
}

}  // namespace

json finite_or_null(std::span<const double> values) {
  json list = json::array();
  for (const double value : values) {
    list.push_back(finite_or_null(value));
  }
  return list;
}

json pack_f32(std::span<const float> values) {
  return {{"f32", pack(values)}};
}

json pack_u32(std::span<const std::uint32_t> values) {
  return {{"u32", pack(values)}};
}

json make_quantity(const Quantity& quantity, bool own_unit) {
  json made = {{"name", quantity.name}, {"unit", quantity.unit}};
  if (own_unit) {
    made["own_unit"] = true;
  }
  return made;
}

json make_fact(std::string_view label, std::string_view value) {
  return {{"label", label}, {"value", value}};
}

json make_program() {
  return {{"version", get_version()}, {"commit", describe_build().at("git")}};
}

std::string dump_page(const json& page) {
  return page.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace armwright
