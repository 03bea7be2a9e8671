// Reads what [control] says of the interface between the controllers and the drives.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "problems/config/problem_readers.hpp"

namespace armwright {

const Setting<std::string> kControlInterface{
    "interface", control_interface_names, "effort",
    "what the controllers command: efforts, or the velocities or positions of drives with an inner "
    "loop"};
// The defaults are assumptions of armwright about the drives of industrial arms.
const Setting<double> kControlBandwidth{
    "bandwidth_hz",
    {.lower = 0.1, .upper = 10'000},
    30,
    "bandwidth of the drives' inner loop of the velocity, for an interface of velocities or "
    "positions"};
const Setting<double> kControlDelay{
    "delay_s",
    {.lower = 0, .upper = 0.1},
    0.004,
    "time from a command to its effect in a drive, rounded to whole physics steps"};
const Setting<double> kControlResolution{
    "resolution_rad",
    {.lower = 0, .upper = 0.1},
    0,
    "resolution of the positions that drives with an inner loop measure; 0: they are exact"};
const Setting<double> kControlSlideResolution{
    "resolution_m",
    {.lower = 0, .upper = 0.1},
    0,
    "resolution of the positions that drives with an inner loop measure at joints that slide; 0: "
    "they are exact"};

namespace {

// The largest w h: there a rate decays 19 % more slowly than in continuous time.
constexpr double kMostDecayPerStep = 0.5;
constexpr double kTurn = 2 * std::numbers::pi;  // rad

}  // namespace

void read_drives(const ConfigTable& control, TrackingTask& task) {
  ArmDrives drives;
  drives.interface = static_cast<ControlInterface>(control.get_choice(kControlInterface));
  const Setting<double>* const of_loops[] = {&kControlBandwidth, &kControlDelay,
                                             &kControlResolution, &kControlSlideResolution};
  if (!drives.has_loops()) {
    control.leave_out(kControlInterface);  // so recorded version 1.0
    for (const auto* setting : of_loops) {
      if (control.has(*setting)) {
        control.refuse(*setting,
                       "it belongs to drives with an inner loop; set control.interface to "
                       "\"velocity\" or \"position\", or leave it out");
      }
    }
    return;
  }
  const bool has_bandwidth = control.has(kControlBandwidth);
  const double bandwidth_hz = control.get(kControlBandwidth);
  drives.bandwidth_rad_per_s = kTurn * bandwidth_hz;
  drives.delay_s = control.get(kControlDelay);
  control.settle(kControlBandwidth, bandwidth_hz);  // a later version may assume others
  control.settle(kControlDelay, drives.delay_s);
  drives.resolution_rad = control.get(kControlResolution);
  drives.resolution_m = control.get(kControlSlideResolution);
  const double step_s = task.control_period_s / task.physics.substeps;
  const double decay = drives.bandwidth_rad_per_s * step_s;
  if (decay > kMostDecayPerStep) {
    const AnySetting* given = &kControlInterface;
    if (has_bandwidth) {
      given = &kControlBandwidth;
    }
    control.refuse(
        *given,
        fmt::format(
            "the drives' bandwidth of {:.6g} Hz is {:.3g} rad per physics step of {:.4g} s; "
            "at most {} can be simulated: set physics.substeps to {:.0f} or more, or "
            "control.bandwidth_hz to {:.3g} or less",
            bandwidth_hz, decay, step_s, kMostDecayPerStep,
            std::ceil(task.physics.substeps * decay / kMostDecayPerStep),
            0.99 * kMostDecayPerStep / (kTurn * step_s)));
  }
  task.drives = drives;
}

}  // namespace armwright
