#include "report/evidence/signals.hpp"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// A piece of a signal in which its formula is one polynomial.
struct Piece {
  double begin_s = 0;
  double end_s = 0;
  std::function<double(double)> distance_m, speed_m_per_s, acceleration_m_per_s2;
};

std::vector<Piece> make_pieces(const targets::SignalCurve& curve) {
  const double whole = curve.distance_m;
  const double speed = curve.speed_m_per_s;
  const double duration = curve.duration_s;
  const double a = curve.acceleration_m_per_s2;
  const double ramp_up = curve.shape == SignalShape::triangular ? duration / 2 : curve.ramp_up_s;
  const Piece up{0, ramp_up, [=](double t) { return a / 2 * t * t; },
                 [=](double t) { return a * t; }, [=](double) { return a; }};
  const Piece plateau{ramp_up, duration - ramp_up,
                      [=](double t) { return a * ramp_up * (t - ramp_up / 2); },
                      [=](double) { return a * ramp_up; }, [](double) { return 0.0; }};
  const Piece down{duration - ramp_up, duration,
                   [=](double t) { return whole - a / 2 * (duration - t) * (duration - t); },
                   [=](double t) { return a * (duration - t); }, [=](double) { return -a; }};
  switch (curve.shape) {
    case SignalShape::step:
      return {};
    case SignalShape::ramp:
      return {{0, duration, [=](double t) { return speed * t; }, [=](double) { return speed; },
               [](double) { return 0.0; }}};
    case SignalShape::trapezoid:
      return {up, plateau, down};
    case SignalShape::triangular:
      return {up, down};
    case SignalShape::complex:
      break;
  }
  const double peak_s = 0.4 * duration;
  const auto left = [=](double t) { return whole - speed * t; };
  return {
      {0, peak_s, [=](double t) { return 25 * speed * speed * t * t / (8 * whole); },
       [=](double t) { return 25 * speed * speed * t / (4 * whole); },
       [=](double) { return 25 * speed * speed / (4 * whole); }},
      {peak_s, duration,
       [=](double t) { return whole - 125 * left(t) * left(t) * left(t) / (54 * whole * whole); },
       [=](double t) { return 125 * speed * left(t) * left(t) / (18 * whole * whole); },
       [=](double t) { return -125 * speed * speed * left(t) / (9 * whole * whole); }}};
}

}  // namespace

std::string make_signal_title(SignalShape shape) {
  std::string title = signal_names()[static_cast<std::size_t>(shape)];
  title.front() = static_cast<char>(title.front() - 'a' + 'A');
  return title;
}

std::vector<SignalSample> sample_signal(SignalShape shape, double distance_m, double speed_m_per_s,
                                        double acceleration_m_per_s2, double rest_s) {
  constexpr int kParts = 60;  // per piece; the curve looks smooth
  const targets::SignalCurve curve =
      make_signal_curve(shape, distance_m, speed_m_per_s, acceleration_m_per_s2);
  std::vector<SignalSample> samples = {{}};  // at rest, before the move
  for (const Piece& piece : make_pieces(curve)) {
    for (int i = 0; i <= kParts; ++i) {
      const double t =
          i == kParts ? piece.end_s : piece.begin_s + (piece.end_s - piece.begin_s) * i / kParts;
      samples.push_back(
          {t, piece.distance_m(t), piece.speed_m_per_s(t), piece.acceleration_m_per_s2(t)});
    }
  }
  samples.push_back({samples.back().time_s, distance_m, 0, 0});
  samples.push_back({curve.duration_s + rest_s, distance_m, 0, 0});
  return samples;
}

double choose_signal_distance(const TrackingTask& task) {
  constexpr double kThesisLimit_m = 0.9;
  return task.distance_limit_m > 0 ? task.distance_limit_m : kThesisLimit_m;
}

json make_signals(const TrackingTask& task, bool name_used) {
  const double distance_m = choose_signal_distance(task);
  json curves = json::array();
  for (std::size_t i = 0; i < signal_names().size(); ++i) {
    const auto shape = static_cast<SignalShape>(i);
    json curve = {{"name", make_signal_title(shape)},
                  {"time_s", json::array()},
                  {"distance_m", json::array()},
                  {"speed_m_per_s", json::array()},
                  {"acceleration_m_per_s2", json::array()}};
    for (const SignalSample& sample :
         sample_signal(shape, distance_m, task.speed_m_per_s, task.trapezoid_acceleration_m_per_s2,
                       task.rest_s)) {
      curve["time_s"].push_back(sample.time_s);
      curve["distance_m"].push_back(sample.distance_m);
      curve["speed_m_per_s"].push_back(sample.speed_m_per_s);
      curve["acceleration_m_per_s2"].push_back(sample.acceleration_m_per_s2);
    }
    curves.push_back(std::move(curve));
  }
  // The speed over the length of the move: two straight lines, which meet at the limit.
  const double limit_m = task.distance_limit_m;
  json reduction = {{"distance_m", {0.0}},
                    {"speed_m_per_s", {limit_m > 0 ? 0.0 : task.speed_m_per_s}},
                    {"limit_m", limit_m}};
  constexpr int kSteps = 20;
  for (int i = 1; i <= 2 * kSteps; ++i) {
    const double move_m = distance_m * i / kSteps;
    reduction["distance_m"].push_back(move_m);
    reduction["speed_m_per_s"].push_back(task.speed_m_per_s *
                                         (move_m < limit_m ? move_m / limit_m : 1));
  }
  return {{"distance_m", distance_m},    {"speed_m_per_s", task.speed_m_per_s},
          {"rest_s", task.rest_s},       {"used", name_used ? make_signal_title(task.signal) : ""},
          {"curves", std::move(curves)}, {"reduction", std::move(reduction)}};
}

}  // namespace armwright
