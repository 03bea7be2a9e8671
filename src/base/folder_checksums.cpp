#include "base/folder_checksums.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_descriptor.hpp"
#include "base/hash.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::size_t kLimit_bytes = std::size_t{64} << 20;
constexpr std::size_t kDigits = 64;
constexpr std::string_view kGap = "  ";

// Returns whether it is a relative path inside the folder, written as armwright writes it.
bool is_plain_name(const std::string& name) {
  const std::filesystem::path path(name);
  return !name.empty() && path.is_relative() && path.lexically_normal() == path &&
         *path.begin() != ".." && *path.begin() != "." && path.has_filename() &&
         std::ranges::none_of(name, [](unsigned char c) { return c < 0x20 || c == '\\'; });
}

bool is_digit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

// Returns the fault of a line, or an empty text. Lines are sorted by name without repetition.
std::string find_line_fault(std::string_view line, const std::string& name_before) {
  if (line.size() <= kDigits + kGap.size() ||
      !std::ranges::all_of(line.substr(0, kDigits), is_digit) ||
      line.substr(kDigits, kGap.size()) != kGap) {
    return "it is not a SHA-256, two spaces and a name";
  }
  const std::string name(line.substr(kDigits + kGap.size()));
  if (!is_plain_name(name)) {
    return "its name is not that of a file in this folder";
  }
  return name <= name_before ? "its name does not follow that of the line before" : "";
}

// Reads the file piece by piece, because a journal may be larger than the memory.
std::string calc_file_sha256(const FileDescriptor& descriptor, const std::filesystem::path& file) {
  constexpr std::size_t kPiece_bytes = std::size_t{256} << 10;
  std::string piece(kPiece_bytes, '\0');
  return calc_sha256_hex([&]() -> std::string_view {
    ssize_t got = -1;
    do {
      got = ::read(descriptor.get(), piece.data(), piece.size());
    } while (got < 0 && errno == EINTR);
    if (got < 0) {
      fail_io(file, "read it", errno);
    }
    return std::string_view(piece).substr(0, static_cast<std::size_t>(got));
  });
}

std::filesystem::path get_folder(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

}  // namespace

FolderChecksums::FolderChecksums(std::filesystem::path folder) : folder_(std::move(folder)) {
  const auto file = folder_ / kChecksumFile;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    return;
  }
  is_there_ = true;
  const std::string text = read_file(file, kLimit_bytes);
  std::string name;
  std::size_t number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    ++number;
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    const std::string fault =
        end == std::string_view::npos ? "it is cut short" : find_line_fault(line, name);
    if (!fault.empty()) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}:{}: is not a line of checksums that armwright wrote ({}); check "
                              "the folder with 'armwright doctor {}'",
                              sanitize(file.string()), number, fault, sanitize(folder_.string())));
    }
    name = line.substr(kDigits + kGap.size());
    lines_.emplace_hint(lines_.end(), name, line.substr(0, kDigits));
    rest.remove_prefix(end + 1);
  }
}

FolderChecksums::FolderChecksums(const Folder& folder) : FolderChecksums(folder.path()) {
  open_ = folder;
}

std::string FolderChecksums::describe_change(const std::string& name,
                                             const std::string& sha256) const {
  const auto line = lines_.find(name);
  return line == lines_.end() || line->second == sha256
             ? ""
             : fmt::format(
                   "was changed after it was written (its SHA-256 is {}..., {} has "
                   "{}...)",
                   sha256.substr(0, 16), kChecksumFile, line->second.substr(0, 16));
}

std::string FolderChecksums::read(const std::string& name, std::size_t limit_bytes) const {
  const auto file = folder_ / name;
  std::string content = read_file(file, limit_bytes);
  if (!covers(name) || describe_change(name, calc_sha256_hex(content)).empty()) {
    return content;
  }
  // A process may have replaced the file and its line since the constructor read the lines.
  const FolderChecksums now(folder_);
  content = read_file(file, limit_bytes);
  const std::string change = now.describe_change(name, calc_sha256_hex(content));
  if (!change.empty()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: {}; check the folder with 'armwright doctor {}'",
                            sanitize(file.string()), change, sanitize(folder_.string())));
  }
  return content;
}

void FolderChecksums::check(const std::string& name) const {
  if (!covers(name)) {
    return;
  }
  std::error_code ignored;
  if (!std::filesystem::exists(folder_ / name, ignored)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is missing, and {} lists it; check the folder with 'armwright "
                            "doctor {}'",
                            sanitize((folder_ / name).string()), kChecksumFile,
                            sanitize(folder_.string())));
  }
  read(name, kLimit_bytes);
}

std::string FolderChecksums::find_change(const std::string& name) const {
  if (!covers(name)) {
    return "";
  }
  const auto file = folder_ / name;
  const FileDescriptor descriptor = open_to_read(file);
  // A hole reads as zeros and takes no space, so that reading a small file with holes can take
  // hours. Behind the last byte is a hole, too.
  const off_t size = ::lseek(descriptor.get(), 0, SEEK_END);
  const off_t hole = ::lseek(descriptor.get(), 0, SEEK_HOLE);
  if (hole >= 0 && hole < size) {
    return fmt::format(
        "was changed after it was written (it has a hole at byte {}; armwright writes none)", hole);
  }
  ::lseek(descriptor.get(), 0, SEEK_SET);
  return describe_change(name, calc_file_sha256(descriptor, file));
}

void FolderChecksums::drop(std::span<const std::string> names) {
  std::size_t dropped = 0;
  for (const std::string& name : names) {
    dropped += lines_.erase(name);
  }
  if (dropped > 0) {
    has_changed_ = true;
    save();
  }
}

void FolderChecksums::write(std::span<const std::pair<std::string, std::string>> files) {
  std::vector<std::string> changing;
  for (const auto& [name, content] : files) {
    if (!describe_change(name, calc_sha256_hex(content)).empty()) {
      changing.push_back(name);
    }
  }
  drop(changing);
  for (const auto& [name, content] : files) {
    write_file(name, content);
    cover(name, content);
  }
}

void FolderChecksums::write_file(const std::string& name, std::string_view content) const {
  const std::filesystem::path inside(name);
  if (inside.has_parent_path()) {
    write_file_atomically(Folder::make(folder_ / inside.parent_path(), folder_),
                          inside.filename().string(), content);
  } else {
    write_file_atomically(open_ ? *open_ : Folder(folder_), name, content);
  }
}

void FolderChecksums::cover(const std::string& name, std::string_view content) {
  std::string& line = lines_[name];
  std::string sha256 = calc_sha256_hex(content);
  has_changed_ = has_changed_ || line != sha256;
  line = std::move(sha256);
}

void FolderChecksums::cover(const std::string& name) {
  std::error_code ignored;
  if (!covers(name) && std::filesystem::is_regular_file(folder_ / name, ignored)) {
    lines_[name] = calc_file_sha256(open_to_read(folder_ / name), folder_ / name);
    has_changed_ = true;
  }
}

void FolderChecksums::save() {
  if (!has_changed_) {
    return;
  }
  write_file(kChecksumFile, format_checksums(lines_));
  is_there_ = true;
  has_changed_ = false;
}

std::string format_checksums(const std::map<std::string, std::string>& lines) {
  std::string text;
  for (const auto& [name, sha256] : lines) {
    text += fmt::format("{}{}{}\n", sha256, kGap, name);
  }
  return text;
}

std::string read_checked_file(const std::filesystem::path& file, std::size_t limit_bytes) {
  return FolderChecksums(get_folder(file)).read(file.filename().string(), limit_bytes);
}

std::string read_checked_json(const std::filesystem::path& file, std::size_t limit_bytes) {
  std::string text = read_checked_file(file, limit_bytes);
  check_json_depth(text, file.string());
  return text;
}

}  // namespace armwright
