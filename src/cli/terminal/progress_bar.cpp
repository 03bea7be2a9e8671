#include "cli/terminal/progress_bar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "cli/terminal/format.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kRedrawInterval{100};
constexpr seconds kLineInterval{5};
constexpr milliseconds kShortestLineInterval{500};  // also if a tenth takes less time
constexpr int kLongestBar = 30;
constexpr int kShortestBar = 5;

std::uint64_t count_simulated(const Progress& progress) {
  return progress.done - std::min(progress.done, progress.replayed);
}

double calc_share(const Progress& progress) {
  return progress.total == 0 ? 1
                             : std::min(1.0, static_cast<double>(progress.done) /
                                                 static_cast<double>(progress.total));
}

double calc_left_s(const Progress& progress, double cases_per_s) {
  return std::max(0.0, static_cast<double>(progress.total) - static_cast<double>(progress.done)) /
         cases_per_s;
}

bool has_generations(const Progress& progress) {
  return progress.generation > 0 && progress.phase == CaseRole::training;
}

// A piece of the bar's line. If the line is too long, the pieces with the highest rank are left out
// first.
struct Piece {
  std::string text;
  int rank;
};

std::string join_what_fits(std::vector<Piece> pieces, std::size_t width) {
  const auto calc_length = [&] {
    return std::accumulate(pieces.begin(), pieces.end(), std::size_t{0},
                           [](std::size_t sum, const Piece& p) { return sum + p.text.size(); });
  };
  while (pieces.size() > 1 && calc_length() > width) {
    pieces.erase(std::max_element(pieces.begin(), pieces.end(),
                                  [](const Piece& a, const Piece& b) { return a.rank < b.rank; }));
  }
  std::string line;
  for (const Piece& piece : pieces) {
    line += piece.text;
  }
  return line.substr(0, width);
}

}  // namespace

enum class ProgressBar::Mode : std::uint8_t { none, lines, bar };

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
    phase_began_ = now;
    simulated_before_phase_ = count_simulated(progress);
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

double ProgressBar::calc_cases_per_s(const Progress& progress, Clock::time_point now) const {
  constexpr double kLeast_s = 0.3;  // a shorter time gives no useful rate
  const double elapsed_s = duration<double>(now - phase_began_).count();
  const auto simulated =
      static_cast<double>(count_simulated(progress)) - static_cast<double>(simulated_before_phase_);
  return elapsed_s < kLeast_s || simulated <= 0 ? 0 : simulated / elapsed_s;
}

void ProgressBar::draw_bar(const Progress& progress, Clock::time_point now) {
  const double share = calc_share(progress);
  const std::string phase = to_string(progress.phase);
  std::vector<Piece> pieces = {
      {fmt::format(" {:.0f} %", std::floor(100 * share)), 0},
      {fmt::format(" {}/{}", progress.done, progress.total), 3},
  };
  if (const double rate = calc_cases_per_s(progress, now); rate > 0) {
    pieces.push_back({fmt::format("  {}/s", format_significant(rate, 3)), 5});
    pieces.push_back({fmt::format("  ETA {}", format_duration(calc_left_s(progress, rate))), 2});
  }
  if (has_generations(progress)) {
    pieces.push_back({fmt::format("  gen {}", progress.generation), 4});
  }
  if (std::isfinite(progress.best_objective)) {
    pieces.push_back(
        {fmt::format("  best {}", format_quantity(progress.best_objective, objective_.unit)), 1});
  }
  // Some terminals wrap a line that fills the last column.
  const auto width = static_cast<std::size_t>(std::max(get_width(Stream::error) - 1, 1));
  const std::string after = join_what_fits(std::move(pieces), width);
  std::string line = after;
  if (phase.size() + after.size() <= width) {
    const int room = static_cast<int>(width - phase.size() - after.size()) - 3;
    const int length = std::min(room, kLongestBar);
    const int full = static_cast<int>(share * length);
    line = phase +
           (length >= kShortestBar ? fmt::format(" [{:#<{}}{:-<{}}]", "", full, "", length - full)
                                   : "") +
           after;
  }
  write_stderr(fmt::format("\r{}\x1b[K", line));
  drawn_ = true;
}

void ProgressBar::write_line(const Progress& progress, Clock::time_point now) {
  std::string line =
      fmt::format("{} {:.0f} %  {}/{}", to_string(progress.phase),
                  std::floor(100 * calc_share(progress)), progress.done, progress.total);
  if (const double rate = calc_cases_per_s(progress, now); rate > 0) {
    line += fmt::format("  {} cases/s  ETA {}", format_significant(rate, 3),
                        format_duration(calc_left_s(progress, rate)));
  }
  if (has_generations(progress)) {
    line += fmt::format("  generation {}", progress.generation);
  }
  if (std::isfinite(progress.best_objective)) {
    line += fmt::format("  best {}", format_quantity(progress.best_objective, objective_.unit));
  }
  line += '\n';
  write_stderr(line);
}

}  // namespace armwright
