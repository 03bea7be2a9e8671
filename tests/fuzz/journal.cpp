// Journals. An input that begins with '=' is payloads, each behind two bytes of length: it gets the
// journal's beginning, and every payload its frame with the right checksum, which no fuzzer finds.
// Any other input is a journal as it stands. What is read is the same written and read again.
#include "study/journal/journal.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>

#include "base/file_descriptor.hpp"
#include "base/hash.hpp"
#include "fuzz/harness.hpp"
#include "study/journal/journal_format.hpp"

namespace armwright::fuzz {
namespace {

void append_number(std::string& bytes, std::uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>(number >> shift);
  }
}

std::string make_journal(std::string_view input) {
  if (!input.starts_with('=')) {
    return std::string(input);
  }
  input.remove_prefix(1);
  std::string journal(journal_format::kMagic);
  while (input.size() >= 2) {
    const auto low = static_cast<unsigned char>(input[0]);
    const auto high = static_cast<unsigned char>(input[1]);
    const std::string_view payload = input.substr(2, low | high << 8);
    append_number(journal, static_cast<std::uint32_t>(payload.size()));
    append_number(journal, calc_crc32(payload));
    journal += payload;
    input.remove_prefix(2 + payload.size());
  }
  return journal;
}

JournalContent read(const std::string& journal) {
  const FileDescriptor memory(memfd_create("journal", MFD_CLOEXEC));
  require(memory.is_open() && ::write(memory.get(), journal.data(), journal.size()) ==
                                  static_cast<ssize_t>(journal.size()),
          "no memory for a journal");
  return read_journal("/proc/self/fd/" + std::to_string(memory.get()));
}

std::string write(const JournalContent& content) {
  std::string journal(journal_format::kMagic);
  const auto encode_all = [&](const auto& records) {
    for (const EvaluationRecord& record : records) {
      journal_format::encode(record, journal);
    }
  };
  encode_all(content.training);
  encode_all(content.judgements);
  if (content.ended) {
    journal_format::encode(content.end, journal);
  }
  return journal;
}

}  // namespace

void fuzz_journal(std::string_view input) {
  const std::string journal = make_journal(input);
  is_read([&] {
    const JournalContent content = read(journal);
    if (content.torn_bytes == journal.size()) {
      return;  // not even its beginning is whole
    }
    for (std::size_t i = 1; i < content.training.size(); ++i) {
      require(content.training.get_index(i - 1) < content.training.get_index(i),
              "the training is not sorted");
    }
    const std::string text = write(content);
    // A record that is written twice counts once.
    require(text.size() + content.torn_bytes <= journal.size(), "records out of nothing");
    const JournalContent again = read(text);
    require(again.torn_bytes == 0, "a journal without a torn end has one");
    require(write(again) == text, "another journal is read back");
  });
}

}  // namespace armwright::fuzz
