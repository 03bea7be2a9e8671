// Everything that armwright reads from outside, one function an input: whatever the bytes, it is
// read, or refused with an Error in good form. Where something is read, what must hold of it is
// checked. libFuzzer calls these functions (tests/fuzz/libfuzzer), and so does every ordinary
// build's test, with the corpus and with the inputs that once were a bug (replay_test.cpp).
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/error.hpp"

namespace armwright::fuzz {

// A bug of ours: an input that was neither read nor refused as it should be.
class BrokenPromise : public std::logic_error {
  using std::logic_error::logic_error;
};

// Throws BrokenPromise unless it holds.
void require(bool holds, const std::string& what);

// What a refusal says goes to a terminal: printable, not empty, and no longer than people read.
void check_message(std::string_view message);

// Calls `read`. False if it refused with an Error, or what the code at hand has in its place; every
// other exception is left to the caller of the harness.
template <class Refusal = Error, class Read>
bool is_read(const Read& read) {
  try {
    read();
    return true;
  } catch (const Refusal& refusal) {
    check_message(refusal.what());
    return false;
  }
}

// A folder in memory where there is one, emptied by nobody: for what is read by the name of a file.
// One for the whole process and each `name`.
const std::filesystem::path& get_scratch_folder(const std::string& name);

// Without care for power cuts: quick.
void write_scratch(const std::filesystem::path& file, std::string_view content);

void fuzz_problem(std::string_view input);
void fuzz_study(std::string_view input);
void fuzz_design(std::string_view input);
void fuzz_urdf(std::string_view input);
void fuzz_test_cases(std::string_view input);
void fuzz_path(std::string_view input);
void fuzz_gains(std::string_view input);
void fuzz_log(std::string_view input);
void fuzz_messages(std::string_view input);
void fuzz_descriptor(std::string_view input);
void fuzz_journal(std::string_view input);
void fuzz_records(std::string_view input);
void fuzz_manifest(std::string_view input);
void fuzz_export_csv(std::string_view input);
void fuzz_export_json(std::string_view input);
void fuzz_http_request(std::string_view input);

}  // namespace armwright::fuzz
