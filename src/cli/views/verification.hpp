// Verifications and checks of a design as text.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "cli/terminal/terminal.hpp"
#include "study/verification/verification.hpp"
#include "study/verification/winner_check.hpp"

namespace armwright {

// Returns the conclusion as one paragraph. The first row must be the design's own setting.
std::string conclude(const std::string& design, std::span<const VerifyRow> rows);

// Returns the check of a run's winner: a title and one line per setting. Without a check (nothing),
// says that the winner was not checked.
std::string describe_check(const std::optional<WinnerCheck>& check, const Style& style);

}  // namespace armwright
