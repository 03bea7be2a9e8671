#include "problems/perturbation_reader.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "problems/tracking_loader.hpp"

namespace armwright {
namespace {

std::optional<std::pair<double, double>> read_load(
    const ConfigTable& table, std::optional<std::pair<double, double>> fallback) {
  if (!table.has("load_kg")) {
    return fallback;
  }
  const auto values = table.get_numbers("load_kg", {.lower = 0, .upper = 1000});
  if (values.empty()) {
    return {};
  }
  if (values.size() != 2 || values[0] > values[1]) {
    table.refuse("load_kg", "it must be two numbers, the lightest and the heaviest load, or none");
  }
  return std::pair(values[0], values[1]);
}

// Keys that are not there keep what `p` has.
Perturbation read_keys(const ConfigTable& table, Perturbation p) {
  using Where = Perturbation::Where;
  static const std::vector<std::string> places = {"training", "judging", "everywhere"};
  constexpr std::string_view kSetPrefix = "plant/";
  p.set = table.get_string("set", p.set);
  if (!p.set.starts_with(kSetPrefix) || p.set.size() == kSetPrefix.size()) {
    table.refuse("set", "a set of plants must be named plant/ID, as in plant/1");
  }
  const std::string where =
      table.get_choice("apply_to", places, places[static_cast<std::size_t>(p.where)]);
  p.where = where == "training"  ? Where::training
            : where == "judging" ? Where::judging
                                 : Where::everywhere;
  p.mass_relative =
      table.get_number_or("mass_relative", p.mass_relative, {.lower = 0, .upper = 0.9});
  p.load_kg = read_load(table, p.load_kg);
  p.effort_limit_sigma =
      table.get_number_or("effort_limit_sigma", p.effort_limit_sigma, {.lower = 0, .upper = 2});
  p.gain_sigma = table.get_number_or("gain_sigma", p.gain_sigma, {.lower = 0, .upper = 2});
  return p;
}

}  // namespace

ReadPerturbation read_perturbation(const ConfigTable& table, std::size_t /*joints*/) {
  ReadPerturbation read;
  if (!table.get_string("preset", "").empty()) {
    read.preset = resolve_named(table, "preset", "perturbations");
    const ConfigTable preset = ConfigTable::load(*read.preset);
    read.perturbation = read_keys(preset, {});
    preset.refuse_unknown();
    read.settled.emplace_back("perturbation.preset=\"\"");
    const auto keys = nlohmann::json::parse(preset.to_json());
    for (const auto& [key, value] : keys.items()) {
      if (!table.has(key)) {
        read.settled.push_back(fmt::format("perturbation.{}={}", key, value.dump()));
      }
    }
  }
  read.perturbation = read_keys(table, read.perturbation);
  return read;
}

}  // namespace armwright
