// The messages of the protocol between this program and an optimizer in another process
// (docs/plugin-protocol.md), made and read. What does not fit is refused with a ProtocolError that
// completes a sentence beginning with the plugin's name.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

class ProtocolError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct AskMessage {
  std::vector<std::vector<double>> points;
  bool begins_generation = false;
};

std::string make_hello();
std::string make_quit();
// `own_options`: names of options that are ours and not the plugin's.
std::string make_minimize(const ProblemDescription& problem, std::uint64_t seed,
                          const Options& options, std::span<const std::string> own_options,
                          std::int64_t remaining);
std::string make_tell(std::span<const Score> scores, std::int64_t remaining, bool stopped,
                      bool with_residuals);

// An object with a text named "type".
nlohmann::json read_message(const std::string& line);
std::string read_type(const nlohmann::json& message);

// Name, summary, source, capabilities, requirements and options; the rest is left alone.
OptimizerRow read_description(const nlohmann::json& message);
// `inside`: every point must lie within the bounds.
AskMessage read_ask(const nlohmann::json& message, const ProblemDescription& problem, bool inside);
std::vector<double> read_recommendation(const nlohmann::json& message,
                                        const ProblemDescription& problem);

}  // namespace armwright
