// Writes the file of a plant.
#include <fmt/format.h>

#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "problems/config/plant_file.hpp"

namespace armwright {
namespace {

constexpr std::size_t kNumbersPerLine = 6;
constexpr std::size_t kPointStride = 8;
constexpr std::size_t kMostPoints = 129;
// Taking off a payload rounds by less.
constexpr double kSameBody = 1e-10;

// Returns the numbers as a TOML array of several lines.
template <class Numbers>
std::string write_numbers(const Numbers& numbers) {
  std::string text = "[";
  std::size_t count = 0;
  for (const double number : numbers) {
    text += count == 0 ? "" : count % kNumbersPerLine == 0 ? ",\n  " : ", ";
    text += format_exact(number);
    ++count;
  }
  return text + "]";
}

std::string write_texts(const std::vector<std::string>& texts) {
  std::vector<std::string> quoted;
  for (const std::string& text : texts) {
    quoted.push_back("  " + quote_toml(text));
  }
  return "[\n" + join(quoted, ",\n") + "\n]";
}

std::string write_joint(const Joint& joint, const Joint& plain) {
  std::string text;
  const auto plain_numbers = list_plant_numbers(plain);
  for (const auto& [key, value] : list_plant_numbers(joint)) {
    if (value != plain_numbers.at(key)) {
      text += fmt::format("{} = {}\n", key, format_exact(value));
    }
  }
  if (joint.plant.measured == MeasuredSide::link) {
    text += "measured = \"link\"\n";
  }
  if (joint.plant.unactuated) {
    text += "unactuated = true\n";
  }
  const std::string name = quote_toml(joint.name);
  if (!text.empty()) {
    text = fmt::format("\n[joint.{}]\n{}", name, text);
  }
  const Counterbalance& own = joint.plant.counterbalance;
  if (!own.efforts.empty() && !joint.plant.unactuated) {
    Counterbalance model = own;
    model.correct(1, 0);
    const bool turns = joint.kind == JointKind::revolute;
    // Every eighth point: straight lines between them are off by less than 1e-4 of a gas spring.
    const std::size_t stride = model.efforts.size() > kMostPoints ? kPointStride : 1;
    const auto last = static_cast<double>(model.efforts.size() - 1);
    std::vector<double> positions, efforts;
    for (std::size_t i = 0; i < model.efforts.size(); i += stride) {
      const double share = static_cast<double>(i) / last;
      positions.push_back(i + 1 == model.efforts.size()
                              ? model.upper
                              : model.lower + share * (model.upper - model.lower));
      efforts.push_back(model.efforts[i]);
    }
    text += fmt::format("\n[joint.{}.counterbalance]\nscale = {}\nslope = {}\n{} = {}\n{} = {}\n",
                        name, format_exact(own.scale), format_exact(own.slope),
                        turns ? "positions_rad" : "positions_m", write_numbers(positions),
                        turns ? "efforts_n_m" : "efforts_n", write_numbers(efforts));
  }
  return text;
}

std::string write_body(const std::string& key, const Inertial& body) {
  const Eigen::Matrix3d& i = body.inertia_kg_m2;
  const double inertia[] = {i(0, 0), i(0, 1), i(0, 2), i(1, 1), i(1, 2), i(2, 2)};
  return fmt::format("\n[{}]\nmass_kg = {}\ncom_m = {}\ninertia_kg_m2 = {}\n", key,
                     format_exact(body.mass_kg), write_numbers(body.com_m), write_numbers(inertia));
}

std::string write_fitted(const FittedPlant& fitted) {
  std::vector<std::string> names;
  for (const PlantParameter& parameter : fitted.parameters) {
    names.push_back(parameter.name);
  }
  std::vector<double> lower;
  for (Eigen::Index row = 0; row < fitted.covariance.rows(); ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      lower.push_back(fitted.covariance(row, column));
    }
  }
  return fmt::format(
      "\n# The logs leave the parameters uncertain, with a normal distribution. Its covariance "
      "stands\n"
      "# here as the lower triangle, row by row.\n[identification]\nlogs = {}\ndelay_s = "
      "{}\nparameters = {}\n"
      "values = {}\ncovariance = {}\n",
      write_texts(fitted.logs), format_exact(fitted.delay_s), write_texts(names),
      write_numbers(fitted.values), write_numbers(lower));
}

}  // namespace

std::string write_plant(const RobotModel& robot, const RobotModel& urdf, const FittedPlant& fitted,
                        const std::string& head) {
  std::string text = head;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    text += write_joint(robot.joints[i], urdf.joints[i]);
  }
  RobotModel bare = robot;
  if (robot.payload) {
    set_payload(bare, {});
  }
  for (std::size_t i = 0; i < bare.links.size(); ++i) {
    const LinkNumbers own = to_link_numbers(bare.links[i].inertial);
    const LinkNumbers plain = to_link_numbers(urdf.links[i].inertial);
    if ((own - plain).norm() > kSameBody * plain.norm()) {
      text += write_body("link." + quote_toml(bare.links[i].name), bare.links[i].inertial);
    }
  }
  if (robot.payload) {
    text += write_body("payload", *robot.payload);
  }
  return text + write_fitted(fitted);
}

}  // namespace armwright
