// Whether the files that were derived from a journal can be read and say what it says. All of them
// can be made again from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace armwright {

// Each: empty, or what is wrong with the file. Error{io} where the operating system refuses to read
// it. The files are not changed.

// Comma-separated, a line of titles, all rows as long as that, the last one whole.
// `last`: what the last row must begin with, if it is known.
std::string find_csv_fault(const std::filesystem::path& file,
                           std::optional<std::uint64_t> last = std::nullopt);
std::string find_json_fault(const std::filesystem::path& file);
std::string find_toml_fault(const std::filesystem::path& file);
std::string find_design_fault(const std::filesystem::path& file);

// What a run's database must hold.
struct DatabaseRows {
  std::uint64_t training = 0;
  std::uint64_t validation = 0;
  std::uint64_t test = 0;
};
// SQLite's own check, and the number of evaluations.
std::string find_database_fault(const std::filesystem::path& file, const DatabaseRows& rows);

}  // namespace armwright
