// The messages of a bag of ROS 2, whichever file format it has.
//
// Sources: MCAP Format Specification, version 0 (mcap.dev); rosbag2's storage plugins, of which the
// tables `topics`, `messages` and `message_definitions` of sqlite3 are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

struct BagTopic {
  std::string name;
  std::string type;        // "sensor_msgs/JointState": without "/msg"
  std::string encoding;    // of the messages: "cdr"
  std::string definition;  // of the type, as text of ros2msg; empty if the bag has none
  std::size_t messages = 0;
};

struct BagMessage {
  std::size_t topic;  // in Bag::topics
  std::int64_t log_time_ns;
  std::size_t begin, size;  // in Bag::data
};

struct Bag {
  std::string file;
  std::vector<BagTopic> topics;
  std::map<std::string, std::size_t> numbers;  // of topics, by name, type and encoding
  // Only the messages of types that armwright decodes (is_log_type()), in the order of recording.
  std::vector<BagMessage> messages;
  std::string data;

  // Returns the number of the topic, which is added if it is new.
  std::size_t add_topic(std::string name, std::string type, std::string encoding,
                        std::string definition);
  void add_message(std::size_t topic, std::int64_t log_time_ns, std::string_view content);
};

inline constexpr const char* kJointStateType = "sensor_msgs/JointState";
inline constexpr const char* kControllerStateType = "control_msgs/JointTrajectoryControllerState";
bool is_log_type(std::string_view type);

// Return whether the content begins as a file of this format does.
bool is_mcap(std::string_view content);
bool is_sqlite(std::string_view content);

// Read a whole bag. They check the file's structure, sizes and checksums. They throw
// Error{bad_data} that names the byte, or the message, at which the file is damaged or ends.
// read_sqlite_bag() changes two bytes of `content`, which say how SQLite shall write.
Bag read_mcap(std::string_view content, const std::string& file);
Bag read_sqlite_bag(std::string& content, const std::string& file);

}  // namespace armwright
