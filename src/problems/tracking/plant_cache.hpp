// The plants of a problem's cases (perturbation.hpp), made once a case (case_cache.hpp).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "problems/tracking/case_cache.hpp"
#include "problems/tracking/perturbation.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {

struct CasePlant {
  Plant plant;
  std::optional<TrackingSetup> setup;  // if masses or load are not the nominal ones

  std::size_t size_bytes() const;
};

class PlantCache {
 public:
  // The arm without load.
  PlantCache(const Perturbation& perturbation, const RobotModel& robot, const TrackingTask& task);

  // Thread-safe; null where plants of that role are nominal.
  std::shared_ptr<const CasePlant> get(CaseRole role, const std::string& set, std::uint64_t number);
  void clear() { plants_.clear(); }

 private:
  CasePlant make(const std::string& set, std::uint64_t number) const;

  Perturbation perturbation_;
  RobotModel robot_;
  TrackingTask task_;
  CaseCache<CasePlant> plants_;
};

}  // namespace armwright
