#include "study/journal/journal_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <utility>
#include <variant>

#include "base/error.hpp"
#include "study/journal/journal_format.hpp"
#include "study/journal/journal_window.hpp"

namespace armwright {

using journal_format::kMagic;

JournalScan scan_journal(FileDescriptor descriptor, const std::filesystem::path& file) {
  JournalWindow window(descriptor.get(), file);
  const auto begin_bytes = std::min<std::uint64_t>(window.size(), kMagic.size());
  if (window.view(0, begin_bytes) != kMagic.substr(0, begin_bytes)) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not an armwright journal (one begins with "
                                                 "the bytes {}); it was left untouched",
                                                 file.string(), kMagic));
  }
  JournalScan scan;
  if (begin_bytes < kMagic.size()) {
    scan.content.torn_bytes = begin_bytes;
    return scan;
  }
  std::deque<RecordedEvaluations::Place> training;
  std::uint64_t offset = kMagic.size();
  for (std::uint64_t number = 0; offset < window.size(); ++number) {
    RecordAttempt attempt = read_record(window, offset);
    if (!attempt.record) {
      if (const auto next = find_intact_record(window, offset)) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("{}: record {} (from 0) at byte {} is damaged ({}), yet an intact "
                                "one follows at byte {}: that is not what a kill or a power cut "
                                "leaves. {}",
                                file.string(), number, offset, attempt.fault, *next,
                                advise_on_damage(file)));
      }
      if (window.has_given_up()) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("{}: record {} (from 0) at byte {} is damaged ({}), and {}. {}",
                                file.string(), number, offset, attempt.fault, kGivenUp,
                                advise_on_damage(file)));
      }
      break;
    }
    if (scan.content.ended) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: record {} (from 0) at byte {} follows the record that ends the "
                              "run. {}",
                              file.string(), number, offset, advise_on_damage(file)));
    }
    if (auto* const end = std::get_if<EndRecord>(&*attempt.record)) {
      scan.content.ended = true;
      scan.content.end = std::move(*end);
    } else {
      auto& evaluation = std::get<EvaluationRecord>(*attempt.record);
      if (evaluation.cases.role == CaseRole::training) {
        training.push_back({evaluation.index, offset});
      } else {
        scan.content.judgements.push_back(std::move(evaluation));
      }
    }
    offset = attempt.end;
  }
  scan.good_bytes = offset;
  scan.content.torn_bytes = window.size() - offset;
  scan.content.training = {std::move(descriptor), file, std::move(training), offset};
  return scan;
}

JournalContent read_journal(const std::filesystem::path& file) {
  return scan_journal(open_journal(file), file).content;
}

}  // namespace armwright
