// Reads the messages that a program of the user sends: one JSON object per line. A message that
// breaks the protocol is refused with a ProtocolError.
#pragma once

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace armwright {

// A fault in a message. The text completes a sentence that begins with the program's name.
class ProtocolError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Returns what was found as one short line for a message.
std::string quote(const std::string& text);
std::string quote(const nlohmann::json& value);

// Reads an object that has a text named "type". Refuses a line that is nested too deep. The tokens
// NaN, Infinity and -Infinity are no JSON. Refuses them, or reads them as null with
// `allows_nan`.
nlohmann::json read_message(const std::string& line, bool allows_nan = false);
std::string read_type(const nlohmann::json& message);

// The functions below read the fields of a message. A field that is missing or has another type is
// a ProtocolError. `where` names the object in messages: "a description".

const nlohmann::json& require(const nlohmann::json& object, const char* key,
                              const std::string& where);
std::string read_text(const nlohmann::json& object, const char* key, const std::string& where);
double read_number(const nlohmann::json& object, const char* key, const std::string& where);
// Returns whether a text fits command lines and file names; kNameRule says which texts do.
bool is_name(const std::string& text);
inline constexpr const char* kNameRule =
    "a name begins with a letter or digit, goes on with letters, digits, '_', '-' and '.', and has "
    "at most 64 of them";
// Returns the field "name". Refuses what is no name.
std::string read_name(const nlohmann::json& object, const std::string& where);

}  // namespace armwright
