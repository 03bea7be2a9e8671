// Helpers for the tests of the journal.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/temporary_folder.hpp"
#include "study/journal/journal.hpp"

namespace armwright::journal_testing {

// Returns a training record whose fields all depend on its index.
inline EvaluationRecord make_record(std::uint64_t index) {
  const double i = static_cast<double>(index);
  EvaluationRecord record;
  record.index = index;
  record.generation = index / 10;
  record.x = {0.1 * i, -i, 1e-300};
  record.clipped = index % 2 == 1;
  record.cases = {CaseRole::training, "train/1", {index, index + 7}};
  record.evaluation.status = EvaluationStatus::diverged;
  record.evaluation.reason = "case " + std::to_string(index) + ": joint 2";
  record.evaluation.objectives = {1.0 / (i + 3.0)};
  record.evaluation.constraint_values = {-0.5 * i};
  record.evaluation.case_errors = {i, std::numeric_limits<double>::quiet_NaN()};
  record.evaluation.metrics = {2.0 * i, 3.0};
  record.evaluation.residuals = {0.25, i};
  record.evaluation.failed_cases = 1;
  return record;
}

inline std::vector<std::uint64_t> bits(const std::vector<double>& numbers) {
  std::vector<std::uint64_t> result;
  for (const double number : numbers) {
    result.push_back(std::bit_cast<std::uint64_t>(number));
  }
  return result;
}

inline void expect_same(const EvaluationRecord& got, const EvaluationRecord& wanted) {
  SCOPED_TRACE("record " + std::to_string(wanted.index));
  EXPECT_EQ(got.index, wanted.index);
  EXPECT_EQ(got.generation, wanted.generation);
  EXPECT_EQ(bits(got.x), bits(wanted.x));
  EXPECT_EQ(bits(got.proposed), bits(wanted.proposed));
  EXPECT_EQ(got.clipped, wanted.clipped);
  EXPECT_EQ(got.with_jacobian, wanted.with_jacobian);
  EXPECT_EQ(bits(got.evaluation.jacobian), bits(wanted.evaluation.jacobian));
  EXPECT_EQ(got.cases.role, wanted.cases.role);
  EXPECT_EQ(got.cases.set, wanted.cases.set);
  EXPECT_EQ(got.cases.numbers, wanted.cases.numbers);
  EXPECT_EQ(got.evaluation.status, wanted.evaluation.status);
  EXPECT_EQ(got.evaluation.reason, wanted.evaluation.reason);
  EXPECT_EQ(bits(got.evaluation.objectives), bits(wanted.evaluation.objectives));
  EXPECT_EQ(bits(got.evaluation.constraint_values), bits(wanted.evaluation.constraint_values));
  EXPECT_EQ(bits(got.evaluation.case_errors), bits(wanted.evaluation.case_errors));
  EXPECT_EQ(bits(got.evaluation.metrics), bits(wanted.evaluation.metrics));
  EXPECT_EQ(bits(got.evaluation.residuals), bits(wanted.evaluation.residuals));
  EXPECT_EQ(got.evaluation.failed_cases, wanted.evaluation.failed_cases);
}

// Expects the training records make_record(0) to make_record(count - 1).
inline void expect_first_records(const JournalContent& content, std::size_t count) {
  ASSERT_EQ(content.training.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    expect_same(content.training[i], make_record(i));
  }
}

inline std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream << bytes;
}

// Writes a journal of `count` records. Returns the offset at which the first record begins, then
// the offset at which each record ends.
inline std::vector<std::size_t> write_journal(const std::filesystem::path& file,
                                              std::size_t count) {
  JournalContent content;
  Journal journal(file, content);
  std::vector<std::size_t> ends = {std::filesystem::file_size(file)};
  for (std::size_t i = 0; i < count; ++i) {
    journal.append(make_record(i));
    journal.flush();
    ends.push_back(std::filesystem::file_size(file));
  }
  journal.close();
  return ends;
}

// Runs `action` and returns the Error that it throws. If it throws none, the test fails.
template <class Action>
Error catch_error(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no Error was thrown";
  return Error(ErrorKind::usage, "no Error was thrown");
}

}  // namespace armwright::journal_testing
