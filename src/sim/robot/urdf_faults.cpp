// Collects what is wrong with a URDF: faults that the user must mend, and repairs.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostFaultsShown = 20;
constexpr std::size_t kMostPlacesShown = 8;

}  // namespace

void fail_urdf(const std::string& name, int line, const std::string& what) {
  throw UrdfFault(line, fmt::format("{}:{}: {}", name, line, what), what);
}

bool UrdfFaults::attempt(const std::function<void()>& check) {
  try {
    check();
    return true;
  } catch (const UrdfFault& fault) {
    faults_.push_back(fault);
    return false;
  }
}

void UrdfFaults::throw_if_any() const {
  if (faults_.empty()) {
    return;
  }
  if (faults_.size() == 1) {
    throw UrdfFault(faults_.front());
  }
  std::vector<UrdfFault> sorted = faults_;
  std::ranges::stable_sort(sorted, {}, &UrdfFault::line);
  std::string text = fmt::format("{}: {} things to mend", name_, sorted.size());
  for (std::size_t i = 0; i < std::min(sorted.size(), kMostFaultsShown); ++i) {
    text += fmt::format("\n{}", sorted[i].what());
  }
  if (sorted.size() > kMostFaultsShown) {
    text += fmt::format("\nand {} more", sorted.size() - kMostFaultsShown);
  }
  throw Error(ErrorKind::bad_data, text);
}

void UrdfRepairs::add(const std::string& kind, const std::string& place,
                      std::vector<UrdfEdit> edits) {
  auto same = std::ranges::find(kinds_, kind, &Kind::what);
  if (same == kinds_.end()) {
    kinds_.push_back({kind, {}, {}});
    same = kinds_.end() - 1;
  }
  if (std::ranges::find(same->places, place) == same->places.end()) {
    same->places.push_back(place);
  }
  std::ranges::move(edits, std::back_inserter(same->edits));
}

std::vector<UrdfRepair> UrdfRepairs::list() const {
  std::vector<UrdfRepair> repairs;
  for (const Kind& kind : kinds_) {
    const std::size_t shown = std::min(kind.places.size(), kMostPlacesShown);
    std::string what = fmt::format("{}: {}", kind.what, join({kind.places.data(), shown}, ", "));
    if (shown < kind.places.size()) {
      what += fmt::format(" and {} more", kind.places.size() - shown);
    }
    repairs.push_back({std::move(what), kind.edits});
  }
  return repairs;
}

}  // namespace armwright
