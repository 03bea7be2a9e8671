#include "report/formats/export_files.hpp"

#include <fmt/format.h>
#include <stdio.h>
#include <unistd.h>

#include <cerrno>

#include "base/error.hpp"
#include "base/file.hpp"

namespace armwright {
namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Replaces every character by one '_' that is neither a letter, a digit nor among `allowed`. A
// character of several bytes gives one '_' too.
std::string replace_others(std::string_view text, std::string_view allowed) {
  std::string replaced;
  for (const char c : text) {
    const bool continues = (static_cast<unsigned char>(c) & 0xC0) == 0x80;
    if (is_letter(c) || is_digit(c) || allowed.find(c) != std::string_view::npos) {
      replaced += c;
    } else if (!continues) {
      replaced += '_';
    }
  }
  return replaced;
}

}  // namespace

std::filesystem::path check_export_folder(const std::filesystem::path& target) {
  const auto folder = normalize_folder(std::filesystem::absolute(target));
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(folder, ignored)) &&
      !(folder_exists(folder) && list_folder(folder).empty())) {
    throw Error(ErrorKind::usage, fmt::format("{}: exists already, and an export never overwrites "
                                              "anything; choose another folder with --out",
                                              target.string()));
  }
  return folder;
}

void put_in_place(PartialFolder& folder) {
  if (::rename(folder.path().c_str(), folder.target().c_str()) != 0) {
    fail_io(folder.target(), "put it in place", errno);
  }
  folder.release();
}

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), file_(nullptr, std::fclose) {
  make_folder(path_.parent_path());
  file_.reset(std::fopen(path_.c_str(), "wxe"));
  if (file_ == nullptr) {
    fail_io(path_, "write it", errno);
  }
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) {
    fail_io(path_, "write it", errno);
  }
}

void OutputFile::close() {
  const bool whole = std::fflush(file_.get()) == 0 &&
                     (::fsync(::fileno(file_.get())) == 0 || errno == EINVAL || errno == EROFS);
  const int error = errno;
  if (std::fclose(file_.release()) != 0 || !whole) {
    fail_io(path_, "write it", whole ? errno : error);
  }
}

void write_output_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.close();
}

std::string escape_file_name(std::string_view name) {
  constexpr std::size_t kLongest = 80;  // leaves room for what is put around it; 255 is the limit
  std::string escaped = replace_others(name, "_-.").substr(0, kLongest);
  if (escaped.empty()) {
    return "unnamed";
  }
  if (escaped.front() == '.' || escaped.front() == '-') {
    escaped.front() = '_';
  }
  return escaped;
}

std::string escape_column_name(std::string_view name) {
  std::string escaped = replace_others(name, "_");
  return escaped.empty() || !is_letter(escaped.front()) ? "c_" + escaped : escaped;
}

std::string UniqueNames::add(const std::string& name) {
  const auto take = [&](const std::string& one) {
    std::string small;
    for (const char c : one) {
      small += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return taken_.insert(small).second;
  };
  if (take(name)) {
    return name;
  }
  for (int number = 2;; ++number) {
    std::string other = fmt::format("{}{}{}", name, separator_, number);
    if (take(other)) {
      return other;
    }
  }
}

std::map<std::string, std::string> make_file_names(std::span<const std::string> names) {
  UniqueNames unique;
  std::map<std::string, std::string> files;
  for (const std::string& name : names) {
    if (!files.contains(name)) {
      files[name] = unique.add(escape_file_name(name));
    }
  }
  return files;
}

}  // namespace armwright
