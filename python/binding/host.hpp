// What a call from Python brings along for work that takes a while in C++: Ctrl-C reaches the work,
// and progress and messages reach Python, both only ever on the thread that called. No signal
// handler is installed: Python's own has noted the interruption, and the work asks for it wherever
// it asks whether to stop.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/stop_signal.hpp"
#include "study/run/run_observer.hpp"

namespace armwright::python {

namespace py = pybind11;

// The exception itself, with its traceback.
py::object to_exception(const py::error_already_set& error);

// Made, and ended, with the GIL held.
class Host final : public RunObserver {
 public:
  // `listener`: None, or called as listener(message, None) and listener(None, progress), a tuple of
  // phase, done, total, replayed, generation, best (None before there is one).
  explicit Host(py::object listener);

  StopSignal& stop() { return stop_; }
  void limit_time(std::optional<double> limit_s);  // from now on

  // Any thread. What they tell waits for the next look().
  void on_progress(const Progress& progress) override;
  void on_message(const std::string& message) override;

  // Does `work` without the GIL, then tells the listener the last of it. Throws what the work
  // throws, and otherwise what has come up in Python meanwhile: KeyboardInterrupt, an exception of
  // the listener's or of an optimizer's that is none of its failures.
  void run(const std::function<void()>& work);
  // The same on a thread of its own, for work that does not ask whether to stop on the thread that
  // called it.
  void run_aside(const std::function<void()>& work);

  // With the GIL: keeps an exception that ends the work, once, and asks it to stop. raise_held()
  // throws it again, if there is one.
  void hold(const py::error_already_set& error);
  void raise_held() const;

 private:
  using Clock = std::chrono::steady_clock;
  void look_out();  // look(), on the right thread, and not too often
  void look();      // without the GIL: at signals, and tells the listener
  void tell();      // with the GIL
  void finish();

  py::object listener_;
  StopSignal stop_;
  const std::thread::id caller_ = std::this_thread::get_id();
  Clock::time_point last_look_ = Clock::now();
  py::object held_ = py::none();  // an exception
  std::mutex mutex_;              // of what waits
  std::deque<std::string> messages_;
  std::optional<Progress> progress_;
};

}  // namespace armwright::python
