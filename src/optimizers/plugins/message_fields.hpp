// Fields of a plugin's messages, read with distrust: what is missing or of another kind is a
// ProtocolError that says where. `where` names the object: "a description".
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace armwright {

// What was found, for a message: one line, shortened.
std::string quote(const std::string& text);
std::string quote(const nlohmann::json& value);

const nlohmann::json& require(const nlohmann::json& object, const char* key,
                              const std::string& where);
std::string read_text(const nlohmann::json& object, const char* key, const std::string& where);
double read_number(const nlohmann::json& object, const char* key, const std::string& where);
// The field "name", fit for command lines and file names.
std::string read_name(const nlohmann::json& object, const std::string& where);

}  // namespace armwright
