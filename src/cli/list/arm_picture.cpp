#include "cli/list/arm_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

constexpr int kColumns = 56, kRows = 15;
constexpr double kCellHeight = 2;  // in widths of a character

struct Spot {
  int column = 0, row = 0;  // from the upper left
};

// Returns the horizontal unit vector in which the tip, or else the farthest point, lies from the
// first joint.
Eigen::Vector3d find_side(const std::vector<Eigen::Vector3d>& points) {
  const auto reach = [&](const Eigen::Vector3d& point) {
    Eigen::Vector3d way = point - points.front();
    way.z() = 0;
    return way;
  };
  Eigen::Vector3d farthest = reach(points.back());
  constexpr double kNear_m = 1e-3;
  for (const Eigen::Vector3d& point : points) {
    if (farthest.norm() < kNear_m) {
      farthest = reach(point);
    }
  }
  return farthest.norm() < kNear_m ? Eigen::Vector3d(Eigen::Vector3d::UnitX())
                                   : Eigen::Vector3d(farthest.normalized());
}

char choose_stroke(const Spot& from, const Spot& to) {
  const int right = to.column - from.column, down = to.row - from.row;
  if (std::abs(down) * 2 <= std::abs(right)) {
    return '-';
  }
  if (std::abs(right) * 2 <= std::abs(down)) {
    return '|';
  }
  return (right > 0) == (down > 0) ? '\\' : '/';
}

char name_joint(std::size_t number) {
  return number < 9    ? static_cast<char>('1' + number)
         : number < 35 ? static_cast<char>('a' + (number - 9))
                       : '+';
}

}  // namespace

std::string draw_arm(const RobotModel& robot, std::span<const double> q) {
  std::vector<Eigen::Vector3d> points;  // joints and tip
  for (const Eigen::Isometry3d& pose : calc_link_poses(robot, q)) {
    points.push_back(pose.translation());
  }
  points.push_back(calc_tip_position(robot, q));
  const Eigen::Vector3d side = find_side(points);
  points.insert(points.begin(), Eigen::Vector3d::Zero());  // the base
  double left = 0, right = 0, low = 0, high = 0;
  for (const Eigen::Vector3d& point : points) {
    left = std::min(left, side.dot(point));
    right = std::max(right, side.dot(point));
    low = std::min(low, point.z());
    high = std::max(high, point.z());
  }
  const double width_m = std::max(right - left, 1e-9), height_m = std::max(high - low, 1e-9);
  const double cell_m = std::max(width_m / (kColumns - 1), height_m / (kCellHeight * (kRows - 1)));
  const auto place = [&](const Eigen::Vector3d& point) {
    return Spot{static_cast<int>(std::lround((side.dot(point) - left) / cell_m)),
                static_cast<int>(std::lround((high - point.z()) / (kCellHeight * cell_m)))};
  };
  std::vector<std::string> rows(
      static_cast<std::size_t>(std::lround(height_m / (kCellHeight * cell_m))) + 1,
      std::string(kColumns, ' '));
  const auto at = [&](const Spot& cell) -> char& {
    return rows[static_cast<std::size_t>(cell.row)][static_cast<std::size_t>(cell.column)];
  };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Spot from = place(points[i]), to = place(points[i + 1]);
    const int steps = std::max(std::abs(to.column - from.column), std::abs(to.row - from.row));
    for (int step = 0; step <= steps; ++step) {
      const double share = steps == 0 ? 0 : static_cast<double>(step) / steps;
      at({static_cast<int>(std::lround(from.column + share * (to.column - from.column))),
          static_cast<int>(std::lround(from.row + share * (to.row - from.row)))}) =
          i == 0 ? ':' : choose_stroke(from, to);
    }
  }
  // The first of several joints in one cell is shown, and the tip before them.
  at(place(points.front())) = '#';
  for (std::size_t i = points.size() - 2; i > 0; --i) {
    at(place(points[i])) = name_joint(i - 1);
  }
  at(place(points.back())) = '*';
  std::string text;
  for (const std::string& row : rows) {
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace armwright
