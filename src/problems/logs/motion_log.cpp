#include "problems/logs/motion_log.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/logs/bag.hpp"
#include "problems/logs/bag_log.hpp"
#include "problems/logs/csv_log.hpp"
#include "problems/logs/decompression.hpp"
#include "problems/logs/log_check.hpp"
#include "problems/logs/log_units.hpp"

namespace armwright {
namespace {

// --read-limit is the limit that users meet first.
constexpr std::size_t kLargestLog_bytes = std::size_t{4} << 30;

[[noreturn]] void refuse_option(std::string_view option, const std::string& key,
                                const std::string& value, const std::string& allowed) {
  throw Error(ErrorKind::usage,
              fmt::format("--{} {}={}: {} is not possible; {}", option, sanitize(key),
                          sanitize(value), quote_name(value), allowed));
}

std::optional<double> parse_ratio(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto above = parse_finite(text.substr(0, slash));
  const auto below =
      slash == std::string::npos ? std::optional(1.0) : parse_finite(text.substr(slash + 1));
  if (!above || !below || *above / *below == 0 || !std::isfinite(*above / *below)) {
    return std::nullopt;
  }
  return *above / *below;
}

// Returns the bag file of a folder of rosbag2.
std::filesystem::path find_bag_file(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> bags;
  std::vector<std::string> names;
  for (const std::filesystem::path& path : list_folder(folder)) {
    std::string name = path.filename().string();
    const std::string whole = name;
    if (name.ends_with(".zstd")) {
      name.resize(name.size() - 5);
    }
    if (name.ends_with(".mcap") || name.ends_with(".db3")) {
      bags.push_back(path);
      names.push_back(whole);
    }
  }
  if (bags.size() != 1) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: this folder has {} bag files (.mcap, .db3){}; a log is one file; {}",
                    folder.string(), bags.size(), bags.empty() ? "" : ": " + list_quoted(names),
                    bags.empty() ? "name the file" : "give each file as a log of its own"));
  }
  return bags.front();
}

// A recorder that was killed leaves its newest messages in a file beside the database.
void check_write_ahead_log(const std::filesystem::path& file) {
  std::filesystem::path log = file;
  log += "-wal";
  std::error_code unreadable;
  const auto size = std::filesystem::file_size(log, unreadable);
  if (!unreadable && size > 0) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: {} beside it has messages that the recorder did not store in the bag; "
                    "store them: sqlite3 {} 'PRAGMA wal_checkpoint(TRUNCATE)'",
                    file.string(), quote_name(log.filename().string()), file.string()));
  }
}

}  // namespace

void set_log_option(LogOptions& options, std::string_view option, const std::string& key,
                    const std::string& value) {
  if (option == "column") {
    options.columns[key] = value;
  } else if (option == "unit") {
    if (find_log_unit(value) == nullptr) {
      refuse_option(
          option, key, value,
          "units are rad, deg, m, mm, these per second (deg/s), N m, N, s, ms, us and ns");
    }
    options.units[key] = value;
  } else if (option == "gear-ratio") {
    const auto ratio = parse_ratio(value);
    if (!ratio) {
      refuse_option(option, key, value, "a gear ratio is a number or a fraction, such as 1798/7");
    }
    options.gear_ratios[key] = *ratio;
  } else {
    if (value != "1" && value != "+1" && value != "-1") {
      refuse_option(option, key, value, "a sign is 1 or -1");
    }
    options.signs[key] = value == "-1" ? -1 : 1;
  }
}

MotionLog parse_log(std::string content, const std::string& name, const RobotModel& robot,
                    const LogOptions& options) {
  constexpr std::size_t kText_bytes = 4096;
  const LogColumns columns(robot, options);
  if (is_zstd(content)) {
    content = decompress_zstd(content, kLargestLog_bytes, name);
  }
  const std::string_view beginning = std::string_view(content).substr(0, kText_bytes);
  if (is_mcap(content)) {
    return check_recording(read_bag_log(read_mcap(content, name), columns), robot);
  }
  if (is_sqlite(content)) {
    return check_recording(read_bag_log(read_sqlite_bag(content, name), columns), robot);
  }
  if (beginning.find('\0') != std::string_view::npos || beginning.starts_with("#ROSBAG")) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: is neither CSV nor a bag of ROS 2 (MCAP or sqlite3){}", name,
                    beginning.starts_with("#ROSBAG")
                        ? "; it is a bag of ROS 1: convert it, for example by rosbags-convert"
                        : ""));
  }
  if (!options.topic.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("--topic {}: {} is a table and has no topics", options.topic, name));
  }
  return check_recording(read_csv_log(content, name, columns), robot);
}

MotionLog read_log(const std::filesystem::path& file, const RobotModel& robot,
                   const LogOptions& options) {
  const ReadStep step(fmt::format("the log '{}'", file.string()));
  const std::filesystem::path path = folder_exists(file) ? find_bag_file(file) : file;
  check_write_ahead_log(path);
  std::string content = read_input(path, kLargestLog_bytes);
  std::string sha256 = calc_sha256_hex(content);
  MotionLog log = parse_log(std::move(content), path.string(), robot, options);
  log.sha256 = std::move(sha256);
  return log;
}

}  // namespace armwright
