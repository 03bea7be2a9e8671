#include "problems/config/plant_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/decompositions.hpp"
#include "base/error.hpp"

namespace armwright {
namespace {

constexpr Range kBodyNotNegative{.lower = 0, .upper = 1e9};
constexpr Range kBodyAnySign{.lower = -1e9, .upper = 1e9};

const Setting<double> kBodyMass{"mass_kg", kBodyNotNegative, kNoDefault, "mass of the body"};
const Setting<std::vector<double>> kBodyCom{
    "com_m", kBodyAnySign, kNoDefault,
    "centre of mass, three numbers, in the frame of the tip (payload) or of the link"};
const Setting<std::vector<double>> kBodyInertia{
    "inertia_kg_m2", kBodyAnySign, std::vector<double>{},
    "inertia about the centre of mass, in the same frame's axes: xx, xy, xz, yy, yz, zz (default: "
    "a point mass)"};
}  // namespace

const SettingTable kPayloadSettings{.key = "payload",
                                    .settings = {&kBodyMass, &kBodyCom, &kBodyInertia}};

namespace {

const Setting<std::vector<std::string>> kFittedLogs{"logs", std::vector<std::string>{},
                                                    "the logs, each NAME SHA-256"};
const Setting<std::vector<std::string>> kFittedParameters{
    "parameters", kNoDefault, "names of the parameters that were fitted"};
const Setting<std::vector<double>> kFittedValues{"values", kNoDefault, "their values"};
const Setting<std::vector<double>> kFittedCovariance{
    "covariance", kNoDefault, "their covariance: the lower triangle, row by row"};
const Setting<double> kFittedDelay{"delay_s", Range{.lower = -1, .upper = 1}, 0.0,
                                   "age of the recorded efforts"};
}  // namespace

const SettingTable kFittedSettings{.key = "identification",
                                   .settings = {&kFittedLogs, &kFittedParameters, &kFittedValues,
                                                &kFittedCovariance, &kFittedDelay}};

Inertial read_body(const ConfigTable& table) {
  Inertial body;
  body.mass_kg = table.get(kBodyMass);
  const std::vector<double> com_m = table.get(kBodyCom);
  if (com_m.size() != 3) {
    table.refuse(kBodyCom, "it must be three numbers: x, y, z");
  }
  body.com_m = Eigen::Vector3d(com_m[0], com_m[1], com_m[2]);
  const std::vector<double> i = table.get(kBodyInertia);
  if (!i.empty()) {
    if (i.size() != 6) {
      table.refuse(kBodyInertia, "it must be six numbers: xx, xy, xz, yy, yz, zz");
    }
    body.inertia_kg_m2 << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
    const Eigen::Vector3d moments =
        body.inertia_kg_m2.selfadjointView<Eigen::Lower>().eigenvalues();
    const double slack = 1e-9 * std::max(1e-12, moments.cwiseAbs().maxCoeff());
    if (moments[0] < -slack || moments[2] > moments[0] + moments[1] + slack) {
      table.refuse(kBodyInertia,
                   fmt::format("no body has it: its principal moments are {:.6g}, {:.6g} and "
                               "{:.6g}; none may be negative, and none may exceed the sum of the "
                               "others",
                               moments[0], moments[1], moments[2]));
    }
  }
  return body;
}

FittedPlant read_fitted(const ConfigTable& table, const RobotModel& robot) {
  FittedPlant fitted;
  fitted.logs = table.get(kFittedLogs);
  fitted.delay_s = table.get(kFittedDelay);
  const std::vector<std::string> names = table.get(kFittedParameters);
  try {
    fitted.parameters = find_parameters(robot, names);
  } catch (const Error& error) {
    table.refuse(kFittedParameters, error.what());
  }
  fitted.values = table.get(kFittedValues);
  if (fitted.values.size() != names.size()) {
    table.refuse(kFittedValues,
                 fmt::format("it must hold {} numbers, one per parameter", names.size()));
  }
  const std::vector<double> lower = table.get(kFittedCovariance);
  const std::size_t count = names.size();
  if (lower.size() != count * (count + 1) / 2) {
    table.refuse(kFittedCovariance,
                 fmt::format("it must hold {} numbers: the lower triangle of {} rows",
                             count * (count + 1) / 2, count));
  }
  const auto n = static_cast<Eigen::Index>(count);
  fitted.covariance.resize(n, n);
  std::size_t next = 0;
  for (Eigen::Index row = 0; row < n; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      fitted.covariance(row, column) = fitted.covariance(column, row) = lower[next++];
    }
  }
  for (Eigen::Index row = 0; row < n; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      const double most =
          std::sqrt(std::max(0.0, fitted.covariance(row, row) * fitted.covariance(column, column)));
      if (!(std::abs(fitted.covariance(row, column)) <= most * (1 + 1e-9))) {
        table.refuse(kFittedCovariance,
                     fmt::format("no covariance: the number of '{}' and '{}' is larger than their "
                                 "variances allow",
                                 names[static_cast<std::size_t>(row)],
                                 names[static_cast<std::size_t>(column)]));
      }
    }
  }
  return fitted;
}

Inertial read_link_body(const ConfigTable& table) {
  const Inertial body = read_body(table);
  if (!(body.mass_kg > 0)) {
    table.refuse(kBodyMass, "the mass of a link must be above 0");
  }
  return body;
}

}  // namespace armwright
