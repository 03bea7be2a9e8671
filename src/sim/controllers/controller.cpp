#include "sim/controllers/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/controllers/law_table.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using controllers::Fields;

struct ControllerLevel;  // tags the code that this file instantiates
using ControllerNumber = lanes::Single<double, ControllerLevel>;
using LawInput = controllers::LawInput<ControllerNumber>;

template <class Law>
constexpr std::size_t kGains = static_cast<std::size_t>(controllers::kGainCount<Law>);

template <class Law>
void check(std::span<const double> gains, EffortLimits limits, JointKind kind) {
  for (std::size_t k = 0; k < gains.size(); ++k) {
    if (!std::isfinite(gains[k])) {
      throw Error(ErrorKind::usage, fmt::format("controller '{}': {} is {}; it must be finite",
                                                Law::kName, Law::kGains[k].key, gains[k]));
    }
  }
  if (!(limits.min <= limits.max)) {
    throw Error(ErrorKind::usage,
                fmt::format("controller '{}': the effort limits are {} to {} {}; the lower must "
                            "not exceed the upper",
                            Law::kName, limits.min, limits.max,
                            kind == JointKind::prismatic ? "N" : "N m"));
  }
}

// Makes the input of a joint's law for one step.
template <class Input>
Input make_input(double setpoint, double measurement, double dt_s, double feed_forward,
                 EffortLimits limits, JointKind kind, bool first, bool saturated) {
  Input in;
  in.setpoint = setpoint;
  in.measurement = measurement;
  in.feed_forward = feed_forward;
  in.integrating = saturated ? 0.0 : 1.0;
  in.effort_limit = std::max(limits.max, -limits.min);
  in.period_s = dt_s;
  in.frequency_hz = 1 / dt_s;
  in.turns = kind == JointKind::revolute;
  in.first = first;
  in.error = in.wrap_turns(in.setpoint - in.measurement);
  return in;
}

template <class Law>
void calc_holding_states(double effort, EffortLimits limits, std::span<const double> gains,
                         double* states) {
  std::array<ControllerNumber, kGains<Law>> gain;
  std::copy(gains.begin(), gains.end(), gain.begin());
  std::array<ControllerNumber, static_cast<std::size_t>(Law::kStates)> state;
  state.fill(ControllerNumber(0));
  controllers::hold_effort<Law>(
      ControllerNumber(effort), ControllerNumber(limits.min), ControllerNumber(limits.max),
      Fields<ControllerNumber>{gain.data(), 1}, Fields<ControllerNumber>{state.data(), 1});
  std::ranges::transform(state, states, &ControllerNumber::v);
}

struct PidInput : LawInput {
  ControllerNumber wrap_turns(ControllerNumber difference) const {
    return turns ? ControllerNumber(wrap_angle(difference.v)) : difference;
  }
  ControllerNumber calc_rate(ControllerNumber change) const { return change / period_s; }
};

// The PID (controllers/pid.hpp) with the arithmetic that reproduced the published results: it
// divides by the period, where lanes multiply by the inverse, and uses the library's remainder.
class PidController final : public Controller {
 public:
  PidController(double p, double i, double d, EffortLimits limits, JointKind kind)
      : gains_{p, i, d}, limits_(limits), kind_(kind) {
    check<controllers::Pid>(gains_, limits, kind);
  }

  using Controller::step;
  double step(double setpoint, double measurement, double dt_s, double feed_forward) override {
    const auto in = make_input<PidInput>(setpoint, measurement, dt_s, feed_forward, limits_, kind_,
                                         first_, saturated_);
    std::array<ControllerNumber, 3> gains = {gains_[0], gains_[1], gains_[2]};
    std::array<ControllerNumber, 2> states = {states_[0], states_[1]};
    const double wanted = controllers::Pid::calc(in, Fields<ControllerNumber>{gains.data(), 1},
                                                 Fields<ControllerNumber>{states.data(), 1})
                              .v;
    states_ = {states[0].v, states[1].v};
    first_ = false;
    saturated_ = wanted < limits_.min || wanted > limits_.max;
    return std::clamp(wanted, limits_.min, limits_.max);
  }
  void reset() override {
    states_ = {};
    first_ = true;
    saturated_ = false;
  }
  void hold(double effort) override {
    reset();
    calc_holding_states<controllers::Pid>(effort, limits_, gains_, states_.data());
  }
  bool saturated() const override { return saturated_; }

 private:
  std::array<double, 3> gains_;
  std::array<double, 2> states_{};
  EffortLimits limits_;
  JointKind kind_;
  bool first_ = true;
  bool saturated_ = false;
};

// The controller of one joint under any law.
template <class Law>
class LawController final : public Controller {
 public:
  LawController(std::span<const double> gains, EffortLimits limits, JointKind kind)
      : limits_(limits), kind_(kind) {
    check<Law>(gains, limits, kind);
    std::copy(gains.begin(), gains.end(), gains_.begin());
    reset();
  }

  using Controller::step;
  double step(double setpoint, double measurement, double dt_s, double feed_forward) override {
    const auto in = make_input<LawInput>(setpoint, measurement, dt_s, feed_forward, limits_, kind_,
                                         first_, saturated_);
    const double wanted = Law::calc(in, Fields<ControllerNumber>{gains_.data(), 1},
                                    Fields<ControllerNumber>{states_.data(), 1})
                              .v;
    first_ = false;
    saturated_ = wanted < limits_.min || wanted > limits_.max;
    return std::clamp(wanted, limits_.min, limits_.max);
  }
  void reset() override {
    states_.fill(ControllerNumber(0));
    first_ = true;
    saturated_ = false;
  }
  void hold(double effort) override {
    reset();
    controllers::hold_effort<Law>(
        ControllerNumber(effort), ControllerNumber(limits_.min), ControllerNumber(limits_.max),
        Fields<ControllerNumber>{gains_.data(), 1}, Fields<ControllerNumber>{states_.data(), 1});
  }
  bool saturated() const override { return saturated_; }

 private:
  std::array<ControllerNumber, kGains<Law>> gains_;
  std::array<ControllerNumber, static_cast<std::size_t>(Law::kStates)> states_;
  EffortLimits limits_;
  JointKind kind_;
  bool first_ = true;
  bool saturated_ = false;
};

template <class Law>
std::unique_ptr<Controller> make_controller(std::span<const double> gains, EffortLimits limits,
                                            JointKind kind) {
  if (gains.size() != kGains<Law>) {
    std::vector<std::string> names;
    for (const controllers::Gain& gain : Law::kGains) {
      names.emplace_back(gain.name);
    }
    throw Error(ErrorKind::usage,
                fmt::format("controller '{}': {} gains are given; it takes exactly {}: {}",
                            Law::kName, gains.size(), names.size(), join(names, ", ")));
  }
  if constexpr (std::is_same_v<Law, controllers::Pid>) {
    return std::make_unique<PidController>(gains[0], gains[1], gains[2], limits, kind);
  } else {
    return std::make_unique<LawController<Law>>(gains, limits, kind);
  }
}

template <class... Laws>
std::vector<ControllerRow> make_table(controllers::LawList<Laws...>) {
  std::vector<ControllerRow> table = {{Laws::kName, Laws::kSummary, Laws::kFormula, Laws::kGains,
                                       Laws::kInterface, Laws::kFeedForward, 0, Laws::kStates,
                                       Laws::convert, calc_holding_states<Laws>,
                                       make_controller<Laws>}...};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i].law = static_cast<int>(i);
  }
  return table;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

const std::vector<ControllerRow>& controller_table() {
  static const std::vector<ControllerRow> table = make_table(controllers::AllLaws{});
  return table;
}

std::vector<std::string> controller_names() {
  std::vector<std::string> names;
  for (const ControllerRow& row : controller_table()) {
    names.push_back(row.name);
  }
  return names;
}

const ControllerRow& get_plain_controller(ControlInterface interface) {
  return *std::ranges::find(controller_table(), interface, &ControllerRow::interface);
}

const ControllerRow& find_controller(std::string_view name) {
  for (const ControllerRow& row : controller_table()) {
    if (row.name == name) {
      return row;
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("controller", name, controller_names(),
                                                 "armwright list controllers"));
}

std::string get_joint_unit(std::string_view unit, JointKind kind) {
  std::string own(unit);
  if (kind == JointKind::prismatic) {
    replace_all(own, "N m", "N");
    replace_all(own, "rad", "m");
  }
  return own;
}

}  // namespace armwright
