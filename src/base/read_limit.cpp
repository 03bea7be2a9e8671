#include "base/read_limit.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/file_descriptor.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr double kMebi = 1024.0 * 1024.0;
constexpr double kFirstReport_s = 1;
constexpr double kMemoryLook_s = 0.02;  // reading /proc costs more than reading a clock

struct Policy {
  ReadLimit limit;
  StopSignal* stop;
  std::function<void(const std::string&)> report;
};

// Set once, before threads start.
std::optional<Policy> g_policy;

// The reading of one thread, from its outermost step on.
struct Reading {
  std::vector<std::string> steps;
  double began_s = 0;
  double next_report_s = 0;
  double next_look_s = 0;
  std::uint64_t memory_before = 0;
  bool was_stopped = false;  // whether a stop had been requested before the reading began
};

thread_local Reading t_reading;

double read_thread_time_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Returns the resident memory of this process; 0 if the system does not tell it.
std::uint64_t read_resident_bytes() {
  const FileDescriptor file(::open("/proc/self/statm", O_RDONLY | O_CLOEXEC));
  char text[128] = {};
  if (!file.is_open() || ::read(file.get(), text, sizeof text - 1) <= 0) {
    return 0;
  }
  char* behind_size = nullptr;
  std::strtoull(text, &behind_size, 10);
  return std::strtoull(behind_size, nullptr, 10) *
         static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::string describe_bytes(std::uint64_t bytes) {
  const double mebi = static_cast<double>(bytes) / kMebi;
  return mebi >= 1024 ? fmt::format("{:.4g}GiB", mebi / 1024) : fmt::format("{:.4g}MiB", mebi);
}

std::string describe_steps() {
  const auto& steps = t_reading.steps;
  return steps.size() == 1 ? steps.front() : fmt::format("{} ({})", steps.front(), steps.back());
}

[[noreturn]] void refuse_more(const std::string& took, const ReadLimit& more) {
  throw Error(ErrorKind::bad_data,
              fmt::format("reading {} took more than {}, the limit for what is read before a run "
                          "starts; check the file, or allow more with --read-limit {}",
                          describe_steps(), took, to_string(more)));
}

}  // namespace

std::string to_string(const ReadLimit& limit) {
  return fmt::format("{:g}s,{}", limit.time_s, describe_bytes(limit.memory_bytes));
}

void set_read_limit(const ReadLimit& limit, StopSignal& stop,
                    std::function<void(const std::string&)> report) {
  g_policy = Policy{limit, &stop, std::move(report)};
}

ReadStep::ReadStep(std::string what) {
  if (t_reading.steps.empty() && g_policy) {
    t_reading.began_s = read_thread_time_s();
    t_reading.next_report_s = kFirstReport_s;
    t_reading.next_look_s = 0;
    t_reading.memory_before = read_resident_bytes();
    t_reading.was_stopped = g_policy->stop->requested();
  }
  t_reading.steps.push_back(std::move(what));
}

ReadStep::~ReadStep() {
  t_reading.steps.pop_back();
}

void check_reading() {
  constexpr double kMoreTime = 6;
  constexpr std::uint64_t kMoreMemory = 4;
  Reading& reading = t_reading;
  if (reading.steps.empty() || !g_policy) {
    return;
  }
  const ReadLimit& limit = g_policy->limit;
  const double took_s = read_thread_time_s() - reading.began_s;
  if (!reading.was_stopped && g_policy->stop->requested()) {
    throw WorkStopped{};
  }
  if (took_s > limit.time_s) {
    refuse_more(describe_number(limit.time_s, "s") + " of processor time",
                {kMoreTime * limit.time_s, limit.memory_bytes});
  }
  if (took_s >= reading.next_look_s) {
    reading.next_look_s = took_s + kMemoryLook_s;
    if (read_resident_bytes() > reading.memory_before + limit.memory_bytes) {
      refuse_more(describe_bytes(limit.memory_bytes) + " of memory",
                  {limit.time_s, kMoreMemory * limit.memory_bytes});
    }
  }
  if (took_s >= reading.next_report_s) {
    reading.next_report_s *= 2;
    g_policy->report(fmt::format("still reading {}, for {:.0f} s now", describe_steps(), took_s));
  }
}

}  // namespace armwright
