#include "study/journal/journal_reader.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "study/journal/journal_file.hpp"

namespace armwright {

using journal_format::Frame;
using journal_format::kFrameBytes;
using journal_format::kMagic;
using journal_format::kMaxPayloadBytes;
using journal_format::kProbeBytes;

JournalWindow::JournalWindow(int fd, std::filesystem::path file) : fd_(fd), file_(std::move(file)) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) {
    fail_io(file_, "read it", errno);
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

void JournalWindow::end_at(std::uint64_t offset) {
  size_ = std::min(size_, offset);
  buffer_.clear();
}

std::string_view JournalWindow::view(std::uint64_t offset, std::size_t length) {
  if (offset < begin_ || offset + length > begin_ + buffer_.size()) {
    fill(offset, length);
  }
  return std::string_view(buffer_).substr(offset - begin_, length);
}

std::uint64_t JournalWindow::skip_hole(std::uint64_t offset) const {
  return std::max(offset, find_data(fd_, offset, size_));
}

void JournalWindow::fill(std::uint64_t offset, std::size_t length) {
  constexpr std::uint64_t kChunkBytes = 1 << 20;
  // Threads write records a little out of order, so reading them in order goes back by a few.
  constexpr std::uint64_t kBehindBytes = kChunkBytes / 4;
  begin_ = offset - std::min(offset, kBehindBytes);
  // Reads twice the length: a long record is seldom the last, and a search at every byte behind it
  // would otherwise read as much again for each byte.
  const std::uint64_t wanted = std::max(offset + 2 * std::uint64_t{length} - begin_, kChunkBytes);
  buffer_.resize(std::min(wanted, bytes_from(begin_)));
  std::size_t filled = 0;
  while (filled < buffer_.size()) {
    const ssize_t got = ::pread(fd_, buffer_.data() + filled, buffer_.size() - filled,
                                static_cast<off_t>(begin_ + filled));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      buffer_.clear();  // it is incomplete, and view() must not return it
    }
    if (got < 0) {
      fail_io(file_, "read it", errno);
    }
    if (got == 0) {
      throw Error(ErrorKind::io, fmt::format("{}: became shorter while it was read; is another "
                                             "process changing it?",
                                             file_.string()));
    }
    filled += static_cast<std::size_t>(got);
  }
}

bool JournalWindow::has_given_up() const {
  // A damaged record is read once without success; accidents damage few.
  constexpr std::uint64_t kReadings = 16;
  return misread_bytes_ / kReadings > size_;
}

RecordAttempt read_record(JournalWindow& window, std::uint64_t offset) {
  if (window.bytes_from(offset) < kFrameBytes) {
    return {.fault = "its frame is cut short"};
  }
  const Frame frame = journal_format::decode_frame(window.view(offset, kFrameBytes));
  const std::uint64_t payload_at = offset + kFrameBytes;
  if (frame.payload_bytes < kProbeBytes || frame.payload_bytes > kMaxPayloadBytes) {
    return {.fault = "its length is impossible"};
  }
  if (frame.payload_bytes > window.bytes_from(payload_at)) {
    return {.fault = "it reaches beyond the end of the file"};
  }
  // The cheap test comes first, because the search for intact records tries every byte.
  if (!journal_format::could_begin_payload(window.view(payload_at, kProbeBytes),
                                           frame.payload_bytes)) {
    return {.fault = "its content makes no sense"};
  }
  const std::string_view payload = window.view(payload_at, frame.payload_bytes);
  if (!journal_format::is_payload(payload)) {
    return {.fault = "its content makes no sense"};
  }
  if (calc_crc32(payload) != frame.checksum) {
    window.count_misread(frame.payload_bytes);
    return {.fault = "its checksum is wrong"};
  }
  return {.record = journal_format::decode_payload(payload),
          .end = payload_at + frame.payload_bytes};
}

std::optional<std::uint64_t> find_intact_record(JournalWindow& window, std::uint64_t offset) {
  // File systems make holes of whole pages.
  constexpr std::uint64_t kPageBytes = 4096;
  while (!window.has_given_up() && ++offset < window.size() &&
         window.bytes_from(offset) >= kFrameBytes + kProbeBytes) {
    if (offset % kPageBytes == 0) {
      // The frame of a record may begin with zeros in the hole before it.
      offset = std::max(offset, window.skip_hole(offset) - kFrameBytes);
      if (window.bytes_from(offset) < kFrameBytes + kProbeBytes) {
        break;
      }
    }
    if (read_record(window, offset).record) {
      return offset;
    }
  }
  return std::nullopt;
}

std::string advise_on_damage(const std::filesystem::path& journal) {
  const std::string folder = journal.has_parent_path() ? journal.parent_path().string() : ".";
  return fmt::format(
      "The journal was left untouched: {} saves what is intact, and --new starts a new run",
      quote_command(std::vector<std::string>{"armwright", "doctor", folder, "--repair"}));
}

JournalContent scan_journal(FileDescriptor descriptor, const std::filesystem::path& file) {
  JournalWindow window(descriptor.get(), file);
  const auto begin_bytes = std::min<std::uint64_t>(window.size(), kMagic.size());
  if (window.view(0, begin_bytes) != kMagic.substr(0, begin_bytes)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not an armwright journal (one begins with the bytes {}). {}",
                            file.string(), kMagic, advise_on_damage(file)));
  }
  JournalContent content;
  if (begin_bytes < kMagic.size()) {
    content.torn_bytes = begin_bytes;
    return content;
  }
  std::deque<RecordedEvaluations::Place> training;
  std::uint64_t offset = kMagic.size();
  for (std::uint64_t number = 0; offset < window.size(); ++number) {
    RecordAttempt attempt = read_record(window, offset);
    if (!attempt.record) {
      if (const auto next = find_intact_record(window, offset)) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("{}: record {} at byte {} is damaged ({}), yet an intact "
                                "one follows at byte {}. A kill or a power cut damages only the "
                                "end, so the disk or another program changed the file. {}",
                                file.string(), number + 1, offset, attempt.fault, *next,
                                advise_on_damage(file)));
      }
      if (window.has_given_up()) {
        throw Error(
            ErrorKind::bad_data,
            fmt::format("{}: record {} at byte {} is damaged ({}), and {}. {}", file.string(),
                        number + 1, offset, attempt.fault, kGivenUp, advise_on_damage(file)));
      }
      break;
    }
    const bool continues = std::holds_alternative<ContinueRecord>(*attempt.record);
    if (content.ended && !continues) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: record {} at byte {} follows the record that ends the "
                              "run. {}",
                              file.string(), number + 1, offset, advise_on_damage(file)));
    }
    if (continues) {
      content.ended = false;
      content.late.reset();
    } else if (auto* const end = std::get_if<EndRecord>(&*attempt.record)) {
      content.ended = true;
      content.end = std::move(*end);
    } else if (auto* const late = std::get_if<LateRecommendations>(&*attempt.record)) {
      content.late = std::move(*late);
    } else {
      auto& evaluation = std::get<EvaluationRecord>(*attempt.record);
      if (evaluation.cases.role == CaseRole::training) {
        training.push_back({evaluation.index, offset});
      } else {
        content.judgements.push_back(std::move(evaluation));
      }
    }
    offset = attempt.end;
  }
  content.intact_bytes = offset;
  content.torn_bytes = window.size() - offset;
  content.training = {std::move(descriptor), file, std::move(training), offset};
  return content;
}

JournalContent read_journal(const std::filesystem::path& file) {
  return scan_journal(open_to_read(file), file);
}

}  // namespace armwright
