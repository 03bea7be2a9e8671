#include "cli/progress_bar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/format.hpp"
#include "cli/terminal.hpp"

namespace armwright {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kRedrawInterval{100};
constexpr seconds kLineInterval{5};
constexpr milliseconds kShortestLineInterval{500};  // however fast the tenths pass
constexpr int kLongestBar = 30;

const char* to_string(Progress::Phase phase) {
  switch (phase) {
    case Progress::Phase::training:
      return "training";
    case Progress::Phase::validation:
      return "validation";
    case Progress::Phase::test:
      break;
  }
  return "test";
}

std::uint64_t count_simulated(const Progress& progress) {
  return progress.done - std::min(progress.done, progress.replayed);
}

double calc_share(const Progress& progress) {
  return progress.total == 0 ? 1
                             : std::min(1.0, static_cast<double>(progress.done) /
                                                 static_cast<double>(progress.total));
}

std::string describe_search(const Progress& progress, const Quantity& objective) {
  std::string text;
  if (progress.generation > 0 && progress.phase == Progress::Phase::training) {
    text += fmt::format("  generation {}", progress.generation);
  }
  if (std::isfinite(progress.best_objective)) {
    text += fmt::format("  best {}", format_quantity(progress.best_objective, objective.unit));
  }
  return text;
}

}  // namespace

ProgressBar::ProgressBar(bool quiet, Quantity objective)
    : mode_(quiet                        ? Mode::none
            : is_terminal(Stream::error) ? Mode::bar
                                         : Mode::lines),
      objective_(std::move(objective)) {}

void ProgressBar::on_progress(const Progress& progress) {
  if (mode_ == Mode::none) {
    return;
  }
  const auto now = Clock::now();
  const bool first = !begun_ || progress.phase != last_.phase;
  if (first) {
    begun_ = true;
    pace_ = {now, count_simulated(progress)};
    last_tenth_ = 0;
  }
  last_ = progress;
  const bool complete = progress.done >= progress.total;
  if (mode_ == Mode::bar) {
    if (first || complete || now - last_shown_ >= kRedrawInterval) {
      draw_bar(progress, now);
      last_shown_ = now;
    }
    return;
  }
  const auto tenth = static_cast<std::uint64_t>(10 * calc_share(progress));
  const auto waited = now - last_shown_;
  if (first) {
    last_shown_ = now;
  } else if (waited >= kLineInterval || (tenth > last_tenth_ && waited >= kShortestLineInterval)) {
    write_line(progress, now);
    last_shown_ = now;
    last_tenth_ = tenth;
  }
}

void ProgressBar::on_message(const std::string& message) {
  clear();
  write_message(message);
}

void ProgressBar::clear() {
  if (drawn_) {
    write_stderr("\r\x1b[K");
    drawn_ = false;
  }
}

std::string ProgressBar::describe_rate(const Progress& progress, Clock::time_point now) const {
  constexpr double kLeast_s = 0.3;  // no rate from less
  const double elapsed_s = duration<double>(now - pace_.since).count();
  const auto simulated = static_cast<double>(count_simulated(progress) - pace_.simulated);
  if (elapsed_s < kLeast_s || simulated == 0) {
    return "";
  }
  const double rate = simulated / elapsed_s;
  const double left_s = static_cast<double>(progress.total - progress.done) / rate;
  return fmt::format("  {} cases/s  ETA {}", format_significant(rate, 3), format_duration(left_s));
}

void ProgressBar::draw_bar(const Progress& progress, Clock::time_point now) {
  const double share = calc_share(progress);
  const std::string before = fmt::format("{:<10} ", to_string(progress.phase));
  const std::string after =
      fmt::format(" {:3.0f} %  {}/{}{}{}", std::floor(100 * share), progress.done, progress.total,
                  describe_rate(progress, now), describe_search(progress, objective_));
  const int width =
      get_width(Stream::error) - 1;  // a full last column would wrap on some terminals
  const int room = width - static_cast<int>(before.size() + after.size()) - 2;
  std::string bar;
  if (room >= 5) {
    const int length = std::min(room, kLongestBar);
    const int full = static_cast<int>(share * length);
    bar = fmt::format("[{:#<{}}{:-<{}}]", "", full, "", length - full);
  }
  const std::string line = before + bar + after;
  write_stderr(fmt::format("\r{:.{}}\x1b[K", line, std::max(width, 1)));
  drawn_ = true;
}

void ProgressBar::write_line(const Progress& progress, Clock::time_point now) {
  write_stderr(fmt::format("{} {:.0f} %  {}/{}{}{}\n", to_string(progress.phase),
                           std::floor(100 * calc_share(progress)), progress.done, progress.total,
                           describe_rate(progress, now), describe_search(progress, objective_)));
}

}  // namespace armwright
