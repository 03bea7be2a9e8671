// The messages between this program and an optimizer in another process (docs/plugin-protocol.md):
// how they are made and read. A message that breaks the protocol is refused with a ProtocolError.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// A fault in a message. The text completes a sentence that begins with the plugin's name.
class ProtocolError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The functions below read the fields of a message. A field that is missing or has another type is
// a ProtocolError. `where` names the object in messages: "a description".

// Returns what was found as one short line for a message.
std::string quote(const std::string& text);
std::string quote(const nlohmann::json& value);

const nlohmann::json& require(const nlohmann::json& object, const char* key,
                              const std::string& where);
std::string read_text(const nlohmann::json& object, const char* key, const std::string& where);
double read_number(const nlohmann::json& object, const char* key, const std::string& where);
// Returns the field "name". Refuses what does not fit command lines and file names.
std::string read_name(const nlohmann::json& object, const std::string& where);

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

// Reads an object that has a text named "type".
nlohmann::json read_message(const std::string& line);
std::string read_type(const nlohmann::json& message);

// Reads name, summary, source, capabilities, requirements and options. Ignores other fields.
OptimizerRow read_description(const nlohmann::json& message);
// Reads the points to evaluate. With `inside`, every point must lie within the bounds.
AskMessage read_ask(const nlohmann::json& message, const ProblemDescription& problem, bool inside);
std::vector<double> read_recommendation(const nlohmann::json& message,
                                        const ProblemDescription& problem);

}  // namespace armwright
