// Optimizers that a study's file describes, and that are not here or must not be started: plugins,
// and optimizers of a host program that uses this library, for example a class in Python. Their
// rows serve to read what was recorded. Their runs throw.
//
// The names of a host's optimizers begin with its language: "python:mine". The host program replaces
// the `make` of these rows. The descriptions are the message `description` of
// docs/plugin-protocol.md.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

inline constexpr std::string_view kPythonPrefix = "python:";

// Returns whether a name means an optimizer of a host program.
bool is_host_name(std::string_view name);
// Returns a message that says how to run it.
std::string explain_host_optimizer(std::string_view name);

// Makes a row from a recorded description. Its optimizer throws Error{usage} in minimize(). The
// host program replaces the row's `make`. Throws Error{bad_data} if the text is no description.
OptimizerRow read_host_row(const std::string& name, const std::string& description);

// Returns the description of a plugin as a study records it. `row` has only the options that the
// plugin itself declares; the name of a library's row is empty. Returns an empty text if the
// description cannot be recorded, for example because a library's option has a name that the
// protocol does not allow.
std::string make_description(const OptimizerRow& row);
// Makes the row of a plugin from make_description(). Starts and opens nothing. Throws
// Error{bad_data} if the text is no description.
OptimizerRow read_plugin_row(const std::string& name, const std::string& description);
// Makes the row of a plugin of which only the KEY=VALUE texts of its options are known, as version
// 1.0 recorded it. Every option is a text. Generations and local search count as
// declared, so that no schedule is refused and no baseline is missing.
OptimizerRow make_undescribed_row(const std::string& name, std::span<const std::string> options);

}  // namespace armwright
