#include "problems/logs/bag_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/logs/decompression.hpp"
#include "problems/logs/joint_message.hpp"

namespace armwright {
namespace {

constexpr std::size_t kLargestMessage_bytes = std::size_t{16} << 20;

// The places of a quantity in a message.
struct Field {
  std::size_t point = 0, field = 0;
  std::string name;
};

std::string name_topics(const Bag& bag) {
  constexpr std::size_t kMostShown = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(bag.topics.size(), kMostShown); ++i) {
    const BagTopic& topic = bag.topics[i];
    text += fmt::format("{}{} ({}, {} messages)", i == 0 ? "" : ", ", quote_name(topic.name),
                        topic.type.empty() ? "no type" : sanitize(topic.type.substr(0, 80)),
                        topic.messages);
  }
  return bag.topics.empty() ? "no topic at all"
         : bag.topics.size() > kMostShown
             ? text + fmt::format(" and {} more", bag.topics.size() - kMostShown)
             : text;
}

std::size_t choose_topic(const Bag& bag, const std::string& wanted) {
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < bag.topics.size(); ++i) {
    const BagTopic& topic = bag.topics[i];
    const bool is_wanted = wanted.empty() || topic.name == wanted || topic.name == "/" + wanted;
    if (is_wanted && is_log_type(topic.type) && topic.messages > 0) {
      fitting.push_back(i);
    }
  }
  const std::string types =
      fmt::format("sensor_msgs/msg/JointState and control_msgs/msg/JointTrajectoryControllerState");
  if (fitting.empty()) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: there is no topic{} with messages of joints; possible types are {}; "
                    "the bag has {}",
                    bag.file, wanted.empty() ? "" : " " + quote_name(wanted), types,
                    name_topics(bag)));
  }
  if (fitting.size() > 1) {
    std::vector<std::string> flags;
    for (const std::size_t i : fitting) {
      flags.push_back("--topic " + sanitize(bag.topics[i].name.substr(0, 80)));
    }
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: {} topics have messages of joints; choose one: {}", bag.file,
                            fitting.size(), join(flags, ", ")));
  }
  const BagTopic& topic = bag.topics[fitting.front()];
  if (topic.encoding != "cdr") {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: the messages of {} are encoded as {}; only cdr is possible",
                            bag.file, quote_name(topic.name), quote_name(topic.encoding)));
  }
  return fitting.front();
}

// Returns the names of the points of a controller's state from its definition; none if the bag has
// no definition.
std::vector<std::string> read_point_names(const BagTopic& topic) {
  std::vector<std::string> names;
  for (const std::string& whole : split(topic.definition, '\n')) {
    if (whole.starts_with("====")) {
      break;  // the definitions of the parts follow
    }
    const std::string line = whole.substr(0, whole.find('#'));
    const std::size_t blank = line.find_first_of(" \t");
    const std::string type = line.substr(0, blank);
    if (blank == std::string::npos || !type.ends_with("/JointTrajectoryPoint")) {
      continue;
    }
    const std::size_t begin = line.find_first_not_of(" \t", blank);
    const std::size_t end = line.find_first_of(" \t\r", begin);
    constexpr std::size_t kLongestName = 80;
    names.push_back(begin == std::string::npos
                        ? ""
                        : sanitize(line.substr(begin, std::min(end - begin, kLongestName))));
  }
  return names;
}

class BagLogReader {
 public:
  BagLogReader(const Bag& bag, const LogColumns& columns)
      : bag_(bag),
        columns_(columns),
        topic_(choose_topic(bag, columns.options().topic)),
        is_state_(bag.topics[topic_].type == kJointStateType),
        joint_count_(static_cast<Eigen::Index>(columns.robot().joint_count())) {
    recording_.file = bag.file;
    recording_.topic = bag.topics[topic_].name;
    recording_.time_name = "header.stamp";
    if (!is_state_) {
      point_names_ = read_point_names(bag.topics[topic_]);
      check_point_names();
    }
  }

  Recording read() {
    std::vector<const BagMessage*> messages;
    for (const BagMessage& message : bag_.messages) {
      if (message.topic == topic_) {
        messages.push_back(&message);
      }
    }
    std::ranges::stable_sort(messages, {}, &BagMessage::log_time_ns);
    std::vector<std::int64_t> stamps, log_times;
    std::size_t left_out = 0;
    JointMessage message;
    std::string unpacked;
    for (const BagMessage* stored : messages) {
      ++number_;
      if (number_ % 256 == 0) {
        check_reading();
      }
      std::string_view bytes = std::string_view(bag_.data).substr(stored->begin, stored->size);
      if (is_zstd(bytes)) {
        unpacked = decompress_zstd(bytes, kLargestMessage_bytes, locate());
        bytes = unpacked;
      }
      const std::string fault = is_state_ ? decode_joint_state(bytes, message)
                                          : decode_controller_state(bytes, point_names_, message);
      if (!fault.empty()) {
        fail(fault + fmt::format(" (its topic has the type {})", bag_.topics[topic_].type));
      }
      if (!find_joints(message)) {
        ++left_out;
        continue;
      }
      if (stamps.empty()) {
        recording_.first_row = number_;
        choose_fields(message);
      }
      take_values(message);
      stamps.push_back(message.stamp_ns);
      log_times.push_back(stored->log_time_ns);
    }
    if (stamps.empty()) {
      fail_joints();
    }
    if (left_out > 0) {
      recording_.notes.push_back(
          fmt::format("{} of {} messages of {} have none of the robot's joints and were left out",
                      left_out, messages.size(), quote_name(recording_.topic)));
    }
    set_times(stamps, log_times);
    return std::move(recording_);
  }

 private:
  std::string locate() const {
    return fmt::format("{}, message {} of {}", bag_.file, number_, quote_name(recording_.topic));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::bad_data, fmt::format("{}: {}", locate(), what));
  }

  void check_point_names() const {
    const auto& names = point_names_;
    const bool fits = names.empty() || (names.size() >= 3 && names.size() <= kMostStatePoints &&
                                        (names[0] == "reference" || names[0] == "desired") &&
                                        (names[1] == "feedback" || names[1] == "actual"));
    if (!fits) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: the definition of {} in the bag has the points {}; possible are "
                              "desired, actual and error, or reference, feedback, error and output",
                              bag_.file, quote_name(recording_.topic), list_quoted(names)));
    }
  }

  // Finds the robot's joints among those of the message. Returns false if it has none of them.
  bool find_joints(const JointMessage& message) {
    const bool is_same = std::ranges::equal(message.names, names_);
    if (is_same) {
      return has_joints_;
    }
    names_.assign(message.names.begin(), message.names.end());
    places_.assign(static_cast<std::size_t>(joint_count_), names_.size());
    std::vector<std::string> missing;
    for (Eigen::Index j = 0; j < joint_count_; ++j) {
      const auto found = std::ranges::find(names_, columns_.file_name(j));
      places_[static_cast<std::size_t>(j)] = static_cast<std::size_t>(found - names_.begin());
      if (found == names_.end()) {
        missing.push_back(columns_.file_name(j));
      }
    }
    has_joints_ = missing.size() < static_cast<std::size_t>(joint_count_);
    if (has_joints_ && !missing.empty()) {
      fail(
          fmt::format("it lacks the joints {}; it has {}; if the robot's joints have other names "
                      "there, give them in the robot's order by --joints NAME,NAME,...",
                      list_quoted(missing), list_quoted(names_)));
    }
    return has_joints_;
  }

  [[noreturn]] void fail_joints() const {
    std::vector<std::string> wanted;
    for (Eigen::Index j = 0; j < joint_count_; ++j) {
      wanted.push_back(columns_.file_name(j));
    }
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: the messages of {} have the joints {}, but the robot has {}; give "
                            "the names of the robot's joints there, in the robot's order, by "
                            "--joints NAME,NAME,...",
                            bag_.file, quote_name(recording_.topic), list_quoted(names_),
                            list_quoted(wanted)));
  }

  Field make_field(std::size_t point, std::size_t field) const {
    constexpr std::array<const char*, 4> kStateFields = {"position", "velocity", "", "effort"};
    constexpr std::array<const char*, 4> kPointFields = {"positions", "velocities", "accelerations",
                                                         "effort"};
    constexpr std::array<const char*, 4> kPoints = {"reference", "feedback", "error", "output"};
    if (is_state_) {
      return {0, field, kStateFields[field]};
    }
    const std::string name = point < point_names_.size() ? point_names_[point] : kPoints[point];
    return {point, field, name + "." + kPointFields[field]};
  }

  bool has_values(const JointMessage& message, const Field& field) const {
    if (field.point >= message.point_count) {
      return false;
    }
    const auto& values = message.points[field.point].fields[field.field];
    return std::ranges::any_of(places_, [&](std::size_t place) {
      return place < values.size() && std::isfinite(values[place]);
    });
  }

  // Decides which field of the messages is which quantity, by the first message.
  void choose_fields(const JointMessage& message) {
    const std::size_t feedback = is_state_ ? 0 : 1;
    constexpr std::size_t kOutput = 3;
    std::vector<Field> all;
    for (std::size_t point = 0; point < std::min<std::size_t>(message.point_count, 4); ++point) {
      for (const std::size_t field : {0, 1, 3}) {
        all.push_back(make_field(point, field));
      }
    }
    const auto find_mapped = [&](const char* key) -> const Field* {
      const auto mapped = columns_.options().columns.find(key);
      if (mapped == columns_.options().columns.end()) {
        return nullptr;
      }
      const auto found = std::ranges::find(all, mapped->second, &Field::name);
      if (found == all.end()) {
        std::vector<std::string> names;
        for (const Field& field : all) {
          names.push_back(field.name);
        }
        throw Error(
            ErrorKind::usage,
            fmt::format("--column {}={}: the messages of {} have no such field; they have {}", key,
                        mapped->second, quote_name(recording_.topic), list_quoted(names)));
      }
      return &*found;
    };
    const auto choose = [&](LogQuantity quantity, const char* key, const Field& usual,
                            bool is_needed, bool is_motor) {
      const Field* mapped = find_mapped(key);
      const Field field = mapped != nullptr ? *mapped : usual;
      if (has_values(message, field) || is_needed || mapped != nullptr) {
        add_columns(quantity, field, is_motor);
      }
    };
    for (const auto& [key, field] : columns_.options().columns) {
      constexpr std::array<std::string_view, 5> kKeys = {"position", "velocity", "effort",
                                                         "motor_torque", "reference"};
      if (std::ranges::find(kKeys, key) == kKeys.end()) {
        throw Error(ErrorKind::usage,
                    fmt::format("--column {}={}: {} is a bag; there the names are position, "
                                "velocity, effort, motor_torque and reference, for all joints "
                                "together (--joints gives their names)",
                                key, field, bag_.file));
      }
    }
    choose(LogQuantity::position, "position", make_field(feedback, 0), true, false);
    choose(LogQuantity::velocity, "velocity", make_field(feedback, 1), false, false);
    if (!is_state_) {
      choose(LogQuantity::reference, "reference", make_field(0, 0), false, false);
    }
    const bool is_motor = columns_.options().columns.contains("motor_torque");
    Field effort = make_field(feedback, 3);
    const bool is_mapped = is_motor || columns_.options().columns.contains("effort");
    if (!is_state_ && !is_mapped && !has_values(message, effort) && message.point_count > kOutput &&
        has_values(message, make_field(kOutput, 3))) {
      effort = make_field(kOutput, 3);
      recording_.notes.push_back(
          fmt::format("{} has no measured efforts; efforts are those of {}, which the controller "
                      "asked for",
                      quote_name(recording_.topic), effort.name));
    }
    choose(LogQuantity::effort, is_motor ? "motor_torque" : "effort", effort, true, is_motor);
  }

  void add_columns(LogQuantity quantity, const Field& field, bool is_motor) {
    for (Eigen::Index j = 0; j < joint_count_; ++j) {
      const std::string name = fmt::format("{} of {}", field.name, columns_.file_name(j));
      const double factor =
          columns_.calc_factor(quantity, j, is_motor, "", name,
                               fmt::format("{}: {}", bag_.file, quote_name(recording_.topic)));
      recording_.columns.push_back({name, quantity, j, factor, {}});
      fields_.push_back(field);
    }
  }

  void take_values(const JointMessage& message) {
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      RecordedColumn& column = recording_.columns[i];
      const Field& field = fields_[i];
      const auto& values = message.points[field.point].fields[field.field];
      if (field.point < message.point_count && !values.empty() &&
          values.size() != message.names.size()) {
        fail(fmt::format("it has {} names and {} values in {}; they must be as many",
                         message.names.size(), values.size(), field.name));
      }
      const std::size_t place = places_[static_cast<std::size_t>(column.joint)];
      const bool is_there = field.point < message.point_count && place < values.size();
      const double value = is_there ? values[place] : std::numeric_limits<double>::quiet_NaN();
      column.values.push_back(std::isfinite(value) ? column.factor * value
                                                   : std::numeric_limits<double>::quiet_NaN());
    }
  }

  void set_times(const std::vector<std::int64_t>& stamps,
                 const std::vector<std::int64_t>& log_times) {
    const bool has_stamps =
        std::ranges::any_of(stamps, [](std::int64_t stamp_ns) { return stamp_ns != 0; });
    const auto& times = has_stamps ? stamps : log_times;
    if (!has_stamps) {
      recording_.time_name = "time of recording";
      recording_.notes.push_back(
          fmt::format("the headers of {} have no time stamps; times are those of the recorder",
                      quote_name(recording_.topic)));
    }
    recording_.times_s.reserve(times.size());
    for (const std::int64_t time_ns : times) {
      // The difference of unsigned numbers is right for any two times.
      const auto passed = static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns) -
                                                    static_cast<std::uint64_t>(times.front()));
      recording_.times_s.push_back(static_cast<double>(passed) * 1e-9);
    }
  }

  const Bag& bag_;
  const LogColumns& columns_;
  std::size_t topic_;
  bool is_state_;
  Eigen::Index joint_count_;
  std::vector<std::string> point_names_;
  Recording recording_;
  std::size_t number_ = 0;           // of the message at hand, from 1
  std::vector<std::string> names_;   // of the last message's joints
  std::vector<std::size_t> places_;  // of the robot's joints among them
  bool has_joints_ = false;
  std::vector<Field> fields_;  // of recording_.columns
};

}  // namespace

std::size_t Bag::add_topic(std::string name, std::string type, std::string encoding,
                           std::string definition) {
  const std::size_t middle = type.find("/msg/");
  if (middle != std::string::npos) {
    type.erase(middle, 4);
  }
  // A topic with several publishers has several channels.
  const auto [place, is_new] =
      numbers.try_emplace(name + '\0' + type + '\0' + encoding, topics.size());
  if (is_new) {
    topics.push_back(
        {std::move(name), std::move(type), std::move(encoding), std::move(definition), 0});
  }
  return place->second;
}

void Bag::add_message(std::size_t topic, std::int64_t log_time_ns, std::string_view content) {
  ++topics[topic].messages;
  if (is_log_type(topics[topic].type)) {
    messages.push_back({topic, log_time_ns, data.size(), content.size()});
    data += content;
  }
}

bool is_log_type(std::string_view type) {
  return type == kJointStateType || type == kControllerStateType;
}

Recording read_bag_log(const Bag& bag, const LogColumns& columns) {
  return BagLogReader(bag, columns).read();
}

}  // namespace armwright
