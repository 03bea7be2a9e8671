#include "problems/config/perturbation_reader.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/tracking_loader.hpp"

namespace armwright {
namespace {

// Single precision still tells angles of some turns apart by this.
constexpr double kFinestQuantum_rad = 1e-6;

std::vector<double> read_joints(const ConfigTable& table, std::string_view key, std::size_t joints,
                                std::vector<double> fallback) {
  if (!table.has(key)) {
    return fallback;
  }
  auto values = table.get_numbers(key, {.lower = 0, .upper = 1e6});
  if (!values.empty() && values.size() != joints) {
    table.refuse(key, fmt::format("it must hold {} numbers, one a joint, or none", joints));
  }
  return values;
}

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

const std::vector<std::string>& get_places() {
  static const std::vector<std::string> places = {"training", "judging", "everywhere"};
  return places;
}

// Keys that are not there keep what `p` has.
Perturbation read_keys(const ConfigTable& table, std::size_t joints, Perturbation p) {
  using Where = Perturbation::Where;
  const std::vector<std::string>& places = get_places();
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
  p.viscous_friction_n_m_s_per_rad = read_joints(table, "viscous_friction_n_m_s_per_rad", joints,
                                                 p.viscous_friction_n_m_s_per_rad);
  p.coulomb_friction_n_m =
      read_joints(table, "coulomb_friction_n_m", joints, p.coulomb_friction_n_m);
  p.friction_transition_rad_per_s =
      table.get_number_or("friction_transition_rad_per_s", p.friction_transition_rad_per_s,
                          {.lower = 1e-6, .upper = 1e3});
  p.quantisation_rad =
      table.get_number_or("quantisation_rad", p.quantisation_rad, {.lower = 0, .upper = 0.1});
  if (p.quantisation_rad > 0 && p.quantisation_rad < kFinestQuantum_rad) {
    table.refuse("quantisation_rad", "it must be 0 (none) or at least 1e-6");
  }
  p.delay_s = table.get_number_or("delay_s", p.delay_s, {.lower = 0, .upper = 0.1});
  p.torque_ripple_relative = table.get_number_or("torque_ripple_relative", p.torque_ripple_relative,
                                                 {.lower = 0, .upper = 1});
  p.ripple_cycles_per_turn = static_cast<int>(
      table.get_integer_or("ripple_cycles_per_turn", p.ripple_cycles_per_turn, 1, 10000));
  p.effort_limit_sigma =
      table.get_number_or("effort_limit_sigma", p.effort_limit_sigma, {.lower = 0, .upper = 2});
  p.gain_sigma = table.get_number_or("gain_sigma", p.gain_sigma, {.lower = 0, .upper = 2});
  return p;
}

std::string write_list(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double value : values) {
    words.push_back(format_exact(value));
  }
  return "[" + join(words, ",") + "]";
}

}  // namespace

Perturbation load_perturbation(const std::string& preset, std::size_t joints) {
  const ConfigTable table = ConfigTable::load(resolve_config("perturbations", preset));
  Perturbation perturbation = read_keys(table, joints, {});
  table.refuse_unknown();
  return perturbation;
}

std::vector<std::string> make_overrides(const Perturbation& p) {
  std::vector<double> load_kg;
  if (p.load_kg) {
    load_kg = {p.load_kg->first, p.load_kg->second};
  }
  const std::pair<const char*, std::string> values[] = {
      {"preset", "\"\""},
      {"set", p.set},
      {"apply_to", get_places()[static_cast<std::size_t>(p.where)]},
      {"mass_relative", format_exact(p.mass_relative)},
      {"load_kg", write_list(load_kg)},
      {"viscous_friction_n_m_s_per_rad", write_list(p.viscous_friction_n_m_s_per_rad)},
      {"coulomb_friction_n_m", write_list(p.coulomb_friction_n_m)},
      {"friction_transition_rad_per_s", format_exact(p.friction_transition_rad_per_s)},
      {"quantisation_rad", format_exact(p.quantisation_rad)},
      {"delay_s", format_exact(p.delay_s)},
      {"torque_ripple_relative", format_exact(p.torque_ripple_relative)},
      {"ripple_cycles_per_turn", fmt::format("{}", p.ripple_cycles_per_turn)},
      {"effort_limit_sigma", format_exact(p.effort_limit_sigma)},
      {"gain_sigma", format_exact(p.gain_sigma)}};
  std::vector<std::string> overrides;
  for (const auto& [key, value] : values) {
    overrides.push_back(fmt::format("perturbation.{}={}", key, value));
  }
  return overrides;
}

ReadPerturbation read_perturbation(const ConfigTable& table, std::size_t joints) {
  ReadPerturbation read;
  if (!table.get_string("preset", "").empty()) {
    read.preset = resolve_named(table, "preset", "perturbations");
    const ConfigTable preset = ConfigTable::load(*read.preset);
    read.perturbation = read_keys(preset, joints, {});
    preset.refuse_unknown();
    read.settled.emplace_back("perturbation.preset=\"\"");
    const auto keys = nlohmann::json::parse(preset.to_json());
    for (const auto& [key, value] : keys.items()) {
      if (!table.has(key)) {
        read.settled.push_back(fmt::format("perturbation.{}={}", key, value.dump()));
      }
    }
  }
  read.perturbation = read_keys(table, joints, read.perturbation);
  return read;
}

}  // namespace armwright
