// The messages between this program and an optimizer in another process (docs/plugin-protocol.md):
// how they are made and read. A message that breaks the protocol is refused with a ProtocolError.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"
#include "process/json_message.hpp"

namespace armwright {

struct AskMessage {
  std::vector<std::vector<double>> points;
  bool begins_generation = false;
};

std::string make_hello();
std::string make_quit();
// Makes the message that starts a run. `own_options` are names of options that belong to armwright,
// not to the plugin.
std::string make_minimize(const ProblemDescription& problem, std::uint64_t seed,
                          const Options& options, std::span<const std::string> own_options,
                          std::int64_t remaining);
std::string make_tell(std::span<const Score> scores, std::int64_t remaining, bool stopped,
                      bool with_residuals);

// Reads name, summary, source, capabilities, requirements and options. Ignores other fields.
OptimizerRow read_description(const nlohmann::json& message);
// Reads the points to evaluate. With `inside`, every point must lie within the bounds.
AskMessage read_ask(const nlohmann::json& message, const ProblemDescription& problem, bool inside);
std::vector<double> read_recommendation(const nlohmann::json& message,
                                        const ProblemDescription& problem);

}  // namespace armwright
