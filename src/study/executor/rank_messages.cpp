#include "study/executor/rank_messages.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/build_info.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {

std::string make_rank_message(const WorkerIntroduction& introduction) {
  PacketWriter packet;
  packet.put(RankMessage::ready);
  packet.put(std::string_view(introduction.host));
  packet.put(std::string_view(introduction.cpu));
  packet.put(introduction.threads);
  packet.put(std::string_view(introduction.identity));
  packet.put(std::string_view(introduction.failure));
  return packet.bytes();
}

std::string make_rank_message(RankMessage kind) {
  PacketWriter packet;
  packet.put(kind);
  return packet.bytes();
}

WorkerIntroduction get_introduction(PacketReader& packet) {
  WorkerIntroduction introduction;
  introduction.host = packet.get_text();
  introduction.cpu = packet.get_text();
  introduction.threads = std::max<std::uint64_t>(1, packet.get<std::uint64_t>());
  introduction.identity = packet.get_text();
  introduction.failure = packet.get_text();
  return introduction;
}

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
