// The reference directions of nsga3, and how it measures members along them.
//
// Source: Deb and Jain 2014, An evolutionary many-objective optimization algorithm using
// reference-point-based nondominated sorting approach, part I, section IV. A direction is a point of
// the plane where the sum of the coordinates is 1. Objectives are normalised first: the ideal point,
// the smallest value of each objective so far, becomes 0, and the intercepts of the plane through
// the extreme points become 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace armwright {

// Returns the number of directions, C(objectives + divisions - 1, divisions). Of numbers above
// `most` it returns most + 1. There must be at least one objective and one division.
std::int64_t count_directions(std::size_t objectives, std::int64_t divisions, std::int64_t most);
// Returns all vectors whose coordinates are multiples of 1 / divisions and add up to 1. Source: Das
// and Dennis 1998, Normal-boundary intersection.
std::vector<std::vector<double>> make_directions(std::size_t objectives, std::int64_t divisions);

// The normalisation. It remembers the ideal point and the extreme points over the generations.
class FrontScale {
 public:
  // Learns from the objectives of the members at hand; there must be at least one. `first_front`
  // counts those that come first and are not dominated.
  void update(std::span<const std::vector<double>> objectives, std::size_t first_front);
  // Returns the objectives, normalised.
  std::vector<double> normalise(std::span<const double> objectives) const;
  // Forgets everything: earlier objectives belong to other training cases.
  void reset();

  const std::vector<double>& ideal() const { return ideal_; }
  const std::vector<double>& ranges() const { return ranges_; }  // > 0

 private:
  std::vector<double> ideal_;
  std::vector<std::vector<double>> extremes_;  // objectives, one point per objective
  std::vector<double> ranges_;                 // of each objective, from 0 to 1
};

struct NearestDirection {
  std::size_t direction = 0;  // index
  double distance = 0;        // from the line through 0 and the direction
};
// Returns the direction whose line is nearest to a normalised point. Of equal ones the first counts.
NearestDirection find_nearest_direction(std::span<const double> normalised,
                                        std::span<const std::vector<double>> directions);

}  // namespace armwright
