// Reads a log from a CSV file: a line with the names of the columns, then one line per sample.
// Commas, semicolons or tabs separate the fields; the first line decides.
#pragma once

#include <string>
#include <string_view>

#include "problems/logs/log_columns.hpp"

namespace armwright {

// Reads the columns that `columns` finds; the others may hold anything. An empty field or one that
// is no finite number becomes NaN. Lines before the header that begin with # are skipped.
//
// Throws Error{bad_data} "FILE:LINE: ..." for a text that has no header, a line with another number
// of fields than the header, an empty line before the last sample, and a field that is no number.
Recording read_csv_log(std::string_view text, const std::string& file, const LogColumns& columns);

}  // namespace armwright
