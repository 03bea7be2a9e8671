// A journal's bytes (study/journal_format.hpp) seen through a buffer, and the records in them: a
// journal may be larger than the memory. Only .cpp files include this.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/file_descriptor.hpp"
#include "study/journal/journal_format.hpp"

namespace armwright {

// For reading. Error{io}.
FileDescriptor open_journal(const std::filesystem::path& file);

class JournalWindow {
 public:
  // `fd` is open for reading, and the caller's. Error{io} if it is no regular file.
  JournalWindow(int fd, std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }
  // When this was made: what another process appends afterwards is not looked at.
  std::uint64_t size() const { return size_; }
  // Nothing behind it is looked at any more: a torn end may be cut off meanwhile.
  void end_at(std::uint64_t offset);
  std::uint64_t bytes_from(std::uint64_t offset) const { return size_ - offset; }
  // Valid until the next call. The range lies within the file. Error{io} if it cannot be read.
  std::string_view view(std::uint64_t offset, std::size_t length);

  // Behind damage any place may look like a record, and a file can be made so that each looks as
  // long as the rest: who searches it counts the bytes that were read in vain, and gives up when
  // they are more than any accident explains.
  void begin_search() { misread_bytes_ = 0; }
  void count_misread(std::uint64_t bytes) { misread_bytes_ += bytes; }
  bool has_given_up() const;

 private:
  void fill(std::uint64_t offset, std::size_t length);

  int fd_;
  std::filesystem::path file_;
  std::uint64_t size_ = 0;
  std::uint64_t misread_bytes_ = 0;
  std::uint64_t begin_ = 0;
  std::string buffer_;
};

// What lies at a place where a record should begin.
struct RecordAttempt {
  std::optional<journal_format::Record> record = std::nullopt;
  std::uint64_t end = 0;   // of the record
  const char* fault = "";  // if there is none
};
RecordAttempt read_record(JournalWindow& window, std::uint64_t offset);

// Where the next intact record begins behind `offset`, if anywhere; nowhere once it is given up.
std::optional<std::uint64_t> find_intact_record(JournalWindow& window, std::uint64_t offset);

// Why a search was given up: a clause.
inline constexpr const char* kGivenUp =
    "too many places behind it look like long records and are none, as no accident leaves them: "
    "the search for intact ones was given up";

// What to do about a damaged journal: a whole sentence.
std::string advise_on_damage(const std::filesystem::path& journal);

}  // namespace armwright
