#include "report/page/page_json.hpp"

#include <bit>
#include <cstring>

#include "base/text.hpp"
#include "study/build_info.hpp"

namespace armwright {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "packed numbers are little-endian");

template <class T>
std::string encode(std::span<const T> values) {
  return encode_base64({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

}  // namespace

std::string encode_base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

json packed(std::span<const float> values) {
  return {{"f32", encode(values)}};
}

json packed(std::span<const std::uint32_t> values) {
  return {{"u32", encode(values)}};
}

json finite_or_null(std::span<const double> values) {
  json list = json::array();
  for (const double value : values) {
    list.push_back(finite_or_null(value));
  }
  return list;
}

json make_quantity(const Quantity& quantity) {
  return {{"name", quantity.name}, {"unit", quantity.unit}};
}

json make_fact(std::string_view label, std::string_view value) {
  return {{"label", label}, {"value", value}};
}

json make_program() {
  return {{"version", get_version()}, {"commit", describe_build().at("git")}};
}

std::string make_command(std::span<const std::string> words) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+-_./:=,@%";
  std::vector<std::string> quoted;
  for (const std::string& word : words) {
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      quoted.push_back(word);
      continue;
    }
    std::string& text = quoted.emplace_back("'");
    for (const char c : word) {
      text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    text += '\'';
  }
  return join(quoted, " ");
}

std::string dump_page(const json& page) {
  return page.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace armwright
