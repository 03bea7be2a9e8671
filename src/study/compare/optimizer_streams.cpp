#include "study/compare/optimizer_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "study/compare/study_reader.hpp"

namespace armwright {
namespace {

// Returns the name of the stream of the first such optimizer of a plan. An option that has its
// default is left out, so that an option which a later version adds does not change the name.
std::string calc_stream(const StudyOptimizer& optimizer) {
  nlohmann::json options = nlohmann::json::object();
  for (const OptionSpec& spec : optimizer.row.options) {
    const OptionValue& value = optimizer.parsed.values().at(spec.name);
    if (spec.changes_result && value != spec.fallback) {
      options[spec.name] = to_text(value);
    }
  }
  const nlohmann::json identity = {
      {"name", optimizer.row.name},
      {"options", options},
      {"schedule", optimizer.schedule ? to_text(*optimizer.schedule) : ""},
      {"settings", optimizer.settings}};
  constexpr std::size_t kDigits = 16;
  using Json = nlohmann::json;
  return calc_sha256_hex(identity.dump(-1, ' ', true, Json::error_handler_t::replace))
      .substr(0, kDigits);
}

bool has_stream(const StudyPlan& plan, const std::string& stream) {
  return std::ranges::find(plan.optimizers, stream, &StudyOptimizer::stream) !=
         plan.optimizers.end();
}

void refuse_shared_streams(const StudyPlan& plan) {
  for (auto one = plan.optimizers.begin(); one != plan.optimizers.end(); ++one) {
    const auto other =
        std::find_if(plan.optimizers.begin(), one,
                     [&](const StudyOptimizer& earlier) { return earlier.stream == one->stream; });
    if (other != one) {
      throw Error(ErrorKind::usage,
                  fmt::format("the optimizers '{}' and '{}' have the same stream '{}', so their "
                              "runs would not be independent; take the key `stream` out of one",
                              other->label, one->label, one->stream));
    }
  }
}

}  // namespace

void name_streams(StudyPlan& plan) {
  for (StudyOptimizer& optimizer : plan.optimizers) {
    if (!optimizer.stream.empty()) {
      continue;
    }
    const std::string first = calc_stream(optimizer);
    std::string stream = first;
    for (int occurrence = 2; has_stream(plan, stream); ++occurrence) {
      stream = fmt::format("{}-{}", first, occurrence);
    }
    optimizer.stream = stream;
  }
  refuse_shared_streams(plan);
}

void adopt_streams(const std::filesystem::path& recorded, StudyPlan& plan) {
  const auto optimizers = read_recorded_optimizers(recorded);
  for (StudyOptimizer& optimizer : plan.optimizers) {
    const auto known = std::ranges::find(optimizers, optimizer.label, &NamedOptimizer::label);
    optimizer.stream = known == optimizers.end() ? "" : known->stream;
  }
  name_streams(plan);
}

}  // namespace armwright
