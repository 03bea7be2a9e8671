#include "study/journal/journal_format.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace armwright::journal_format {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the journal's numbers are copied as they lie in memory");
static_assert(sizeof(double) == 8 && sizeof(std::uint64_t) == 8);

constexpr std::uint8_t kEvaluationType = 1;
constexpr std::uint8_t kEndType = 2;
constexpr std::uint8_t kJacobianType = 3;
constexpr std::uint8_t kLateType = 4;
constexpr std::uint8_t kProposalType = 5;
constexpr std::uint8_t kJacobianProposalType = 6;
constexpr std::uint8_t kContinueType = 7;
constexpr unsigned kStatuses = 1 + static_cast<unsigned>(EvaluationStatus::abandoned);

bool has_jacobian(std::uint8_t type) {
  return type == kJacobianType || type == kJacobianProposalType;
}

bool has_proposal(std::uint8_t type) {
  return type == kProposalType || type == kJacobianProposalType;
}

bool is_evaluation(std::uint8_t type) {
  return type == kEvaluationType || has_jacobian(type) || has_proposal(type);
}

// visit_fields lists the fields once, and four visitors measure, write, read and check them.

template <class Fields, class Record>
void visit_evaluation(std::uint8_t type, Fields& fields, Record& record) {
  auto& evaluation = record.evaluation;
  fields.choice(record.clipped, 2);
  fields.choice(record.cases.role, 3);
  fields.choice(evaluation.status, kStatuses);
  fields.number(evaluation.failed_cases);
  fields.number(record.index);
  fields.number(record.generation);
  fields.list(record.cases.set);
  fields.list(record.cases.numbers);
  fields.list(record.x);
  fields.list(evaluation.reason);
  fields.list(evaluation.objectives);
  fields.list(evaluation.constraint_values);
  fields.list(evaluation.case_errors);
  fields.list(evaluation.metrics);
  fields.list(evaluation.residuals);
  if (has_jacobian(type)) {
    fields.list(evaluation.jacobian);
  }
  if (has_proposal(type)) {
    fields.list(record.proposed);
  }
}

template <class Fields, class Record>
void visit_fields(std::uint8_t type, Fields& fields, Record& record) {
  if constexpr (std::is_same_v<std::remove_const_t<Record>, EndRecord>) {
    fields.number(record.evaluations);
    fields.list(record.reason);
  } else if constexpr (std::is_same_v<std::remove_const_t<Record>, LateRecommendations>) {
    fields.number(record.count);
    fields.list(record.x);
  } else if constexpr (std::is_same_v<std::remove_const_t<Record>, ContinueRecord>) {
    fields.number(record.budget);
    fields.number(record.evaluations);
  } else {
    visit_evaluation(type, fields, record);
  }
}

struct Measure {
  std::size_t bytes = 1;  // the type

  template <class T>
  void choice(const T&, unsigned) {
    bytes += 1;
  }
  template <class T>
  void number(const T& value) {
    bytes += sizeof value;
  }
  template <class List>
  void list(const List& values) {
    bytes += 4 + values.size() * sizeof(typename List::value_type);
  }
};

struct Write {
  char* at;

  void raw(const void* bytes, std::size_t count) {
    if (count != 0) {  // an empty list may have no address
      std::memcpy(at, bytes, count);
      at += count;
    }
  }
  template <class T>
  void choice(const T& value, unsigned) {
    *at++ = static_cast<char>(value);
  }
  template <class T>
  void number(const T& value) {
    raw(&value, sizeof value);
  }
  template <class List>
  void list(const List& values) {
    number(static_cast<std::uint32_t>(values.size()));
    raw(values.data(), values.size() * sizeof(typename List::value_type));
  }
};

struct Read {
  std::string_view rest;
  bool good = true;

  bool has(std::size_t bytes) {
    good = good && bytes <= rest.size();
    return good;
  }
  template <class T>
  void choice(T& value, unsigned choices) {
    if (has(1)) {
      const auto byte = static_cast<std::uint8_t>(rest.front());
      good = byte < choices;
      value = static_cast<T>(good ? byte : 0);
      rest.remove_prefix(1);
    }
  }
  template <class T>
  void number(T& value) {
    if (has(sizeof value)) {
      std::memcpy(&value, rest.data(), sizeof value);
      rest.remove_prefix(sizeof value);
    }
  }
  template <class List>
  void list(List& values) {
    std::uint32_t count = 0;
    number(count);
    const std::size_t bytes = std::size_t{count} * sizeof(typename List::value_type);
    if (has(bytes) && bytes != 0) {
      values.resize(count);
      std::memcpy(values.data(), rest.data(), bytes);
      rest.remove_prefix(bytes);
    }
  }
};

// Reads as Read does, but stores no values.
struct Check {
  Read read;

  template <class T>
  void choice(const T&, unsigned choices) {
    T value;
    read.choice(value, choices);
  }
  template <class T>
  void number(const T&) {
    T value;
    read.number(value);
  }
  template <class List>
  void list(const List&) {
    std::uint32_t count = 0;
    read.number(count);
    const std::size_t bytes = std::size_t{count} * sizeof(typename List::value_type);
    if (read.has(bytes)) {
      read.rest.remove_prefix(bytes);
    }
  }
};

template <class Record>
void encode_as(std::uint8_t type, const Record& record, std::string& buffer) {
  Measure measure;
  visit_fields(type, measure, record);
  if (measure.bytes > kMaxPayloadBytes) {
    throw Error(ErrorKind::bad_data,
                fmt::format("a record of {} bytes is too large for the journal; at most {} bytes "
                            "are allowed: evaluate each candidate on fewer cases",
                            measure.bytes, kMaxPayloadBytes));
  }
  const std::size_t begin = buffer.size();
  buffer.resize(begin + kFrameBytes + measure.bytes);
  char* const payload = buffer.data() + begin + kFrameBytes;
  Write write{payload};
  write.number(type);
  visit_fields(type, write, record);
  Write frame{buffer.data() + begin};
  frame.number(static_cast<std::uint32_t>(measure.bytes));
  frame.number(calc_crc32({payload, measure.bytes}));
}

// Calls `on_blank` with the payload's type and an empty record of that type.
template <class OnBlank>
auto with_blank_record(std::string_view payload, OnBlank on_blank)
    -> decltype(on_blank(kEvaluationType, EvaluationRecord())) {
  if (payload.empty()) {
    return {};
  }
  const auto type = static_cast<std::uint8_t>(payload.front());
  if (is_evaluation(type)) {
    EvaluationRecord record;
    record.with_jacobian = has_jacobian(type);
    return on_blank(type, std::move(record));
  }
  switch (type) {
    case kEndType:
      return on_blank(type, EndRecord());
    case kLateType:
      return on_blank(type, LateRecommendations());
    case kContinueType:
      return on_blank(type, ContinueRecord());
    default:
      return {};
  }
}

}  // namespace

void encode(const EvaluationRecord& record, std::string& buffer) {
  const bool is_proposed = !record.proposed.empty();
  const std::uint8_t plain = is_proposed ? kProposalType : kEvaluationType;
  const std::uint8_t differentiated = is_proposed ? kJacobianProposalType : kJacobianType;
  encode_as(record.with_jacobian ? differentiated : plain, record, buffer);
}

void encode(const LateRecommendations& record, std::string& buffer) {
  encode_as(kLateType, record, buffer);
}

void encode(const EndRecord& record, std::string& buffer) {
  encode_as(kEndType, record, buffer);
}

void encode(const ContinueRecord& record, std::string& buffer) {
  encode_as(kContinueType, record, buffer);
}

Frame decode_frame(std::string_view bytes) {
  Read read{bytes};
  Frame frame;
  read.number(frame.payload_bytes);
  read.number(frame.checksum);
  return frame;
}

std::size_t count_whole_record_bytes(std::string_view records) {
  std::size_t whole = 0;
  while (records.size() - whole >= kFrameBytes) {
    const Frame frame = decode_frame(records.substr(whole, kFrameBytes));
    const std::size_t record_bytes = kFrameBytes + frame.payload_bytes;
    if (record_bytes > records.size() - whole) {
      break;
    }
    whole += record_bytes;
  }
  return whole;
}

bool could_begin_payload(std::string_view probe, std::uint32_t payload_bytes) {
  Read read{probe};
  std::uint8_t type = 0;
  read.number(type);
  if (is_evaluation(type)) {
    EvaluationRecord record;
    read.choice(record.clipped, 2);
    read.choice(record.cases.role, 3);
    read.choice(record.evaluation.status, kStatuses);
    return read.good;
  }
  if (type == kContinueType) {
    return payload_bytes == 1 + 2 * sizeof(std::uint64_t);
  }
  // Both other types have a number and one list.
  std::uint64_t number = 0;
  std::uint32_t elements = 0;
  read.number(number);
  read.number(elements);
  const std::uint64_t element_bytes = type == kLateType ? sizeof(double) : 1;
  return (type == kEndType || type == kLateType) && read.good &&
         kProbeBytes + elements * element_bytes == payload_bytes;
}

bool is_payload(std::string_view bytes) {
  return with_blank_record(bytes, [&](std::uint8_t type, const auto& record) {
    Check check{{bytes.substr(1)}};
    visit_fields(type, check, record);
    return check.read.good && check.read.rest.empty();
  });
}

std::optional<Record> decode_payload(std::string_view payload) {
  return with_blank_record(payload, [&](std::uint8_t type, auto record) -> std::optional<Record> {
    Read read{payload.substr(1)};
    visit_fields(type, read, record);
    if (!read.good || !read.rest.empty()) {
      return std::nullopt;
    }
    return record;
  });
}

}  // namespace armwright::journal_format
