#include "study/executor/rank_identity.hpp"

#include <nlohmann/json.hpp>

#include "base/build_info.hpp"

namespace armwright {

std::string make_rank_identity(std::span<const LoadedProblem* const> problems) {
  using nlohmann::json;
  json program = describe_build();
  program.erase("cpu");  // the SIMD level is in each problem's configuration
  program.erase("host");
  json list = json::array();
  for (const LoadedProblem* problem : problems) {
    list.push_back({{"name", problem->name},
                    {"configuration", json::parse(problem->resolved_json)},
                    {"files", problem->input_hashes}});
  }
  return json{{"program", program}, {"problems", list}}.dump();
}

WorkerIntroduction make_introduction(unsigned threads) {
  const auto build = describe_build();
  return {.host = build.at("host"),
          .cpu = build.at("cpu"),
          .threads = threads,
          .identity = "",
          .failure = ""};
}

}  // namespace armwright
