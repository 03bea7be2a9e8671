// The steps of reading a URDF. Only the .cpp files of this folder include this header; other
// modules use robot_model.hpp. All functions throw Error{bad_data} "NAME:LINE: what is wrong, what
// is allowed". `name` is the file's name in messages.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

inline constexpr std::size_t kUrdfLimit_bytes = std::size_t{8} << 20;
inline constexpr std::size_t kUrdfDepthLimit = 64;
inline constexpr std::size_t kUrdfElementLimit = 50'000;
inline constexpr std::size_t kUrdfAttributeLimit = 64;     // per element
inline constexpr std::size_t kUrdfTextLimit_bytes = 4096;  // of a name or a mesh's path
inline constexpr std::size_t kUrdfLinkLimit =
    1'000;  // build_model() recurses once per link of a branch

// The largest accepted number. Larger ones are mistakes, and squares and products must not overflow.
inline constexpr double kUrdfLargest = 1e18;

// The advice in messages about a file that still contains xacro.
inline constexpr std::string_view kXacroAdvice =
    "xacro is not read: expand the file and give armwright the result. ROS 2: ros2 run xacro xacro "
    "my.urdf.xacro > my.urdf. ROS 1: rosrun xacro xacro my.urdf.xacro > my.urdf. Without ROS: pip "
    "install xacrodoc; xacrodoc my.urdf.xacro -o my.urdf. Arguments of the file follow as "
    "name:=value";

// An Error{bad_data} about one place of a URDF.
class UrdfFault final : public Error {
 public:
  UrdfFault(int line, const std::string& message, std::string detail)
      : Error(ErrorKind::bad_data, message), line_(line), detail_(std::move(detail)) {}
  int line() const { return line_; }
  // Returns what is wrong, without the file, the line and the link or joint.
  const std::string& detail() const { return detail_; }

 private:
  int line_;
  std::string detail_;
};

// Collects the faults of a URDF, so that the user sees all of them at once.
class UrdfFaults {
 public:
  // `name` is the file's name in messages. It must outlive the object.
  explicit UrdfFaults(const std::string& name) : name_(name) {}
  // Calls `check` and keeps its UrdfFault. Returns whether it had none.
  bool attempt(const std::function<void()>& check);
  // Returns the fault that was found first, or null.
  const UrdfFault* first() const { return faults_.empty() ? nullptr : &faults_.front(); }
  std::size_t count() const { return faults_.size(); }
  // Throws the only fault, or an Error{bad_data} that lists all in the order of their lines.
  void throw_if_any() const;

 private:
  const std::string& name_;
  std::vector<UrdfFault> faults_;
};

// Collects repairs. Repairs of the same kind become one line that names all their places.
class UrdfRepairs {
 public:
  // `kind` is what was done, `place` is where: "'link_1' (line 12)".
  void add(const std::string& kind, const std::string& place, std::vector<UrdfEdit> edits);
  // Returns the lines in the order in which their kinds were added first.
  std::vector<UrdfRepair> list() const;

 private:
  struct Kind {
    std::string what;
    std::vector<std::string> places;
    std::vector<UrdfEdit> edits;
  };
  std::vector<Kind> kinds_;
};

// Throws UrdfFault "NAME:LINE: WHAT".
[[noreturn]] void fail_urdf(const std::string& name, int line, const std::string& what);

// Checks the text before the XML parser reads it: sizes, nesting, NUL bytes, document types,
// entities, truncation.
void scan_urdf(std::string_view xml, const std::string& name);

// The name of a link, its line in the file and its number among the elements (UrdfEdit).
struct UrdfLink {
  std::string name;
  int line = 0;
  std::size_t element = 0;
  bool has_visual = false;
};
// A joint's name, parent link, child link and type, and its line in the file.
struct UrdfJoint {
  std::string name, parent, child, type;
  int line = 0;
};

// The part of the tree of links that is simulated as the chain.
struct UrdfChain {
  std::string base, tip;                // names of links
  std::map<std::string, int> joints;    // lines of the chain's moving joints, by name
  std::vector<std::string> ends;        // the leaves below the base, in the file's order
  bool is_tip_proposed = false;         // chosen among several ends
  std::set<std::string> moving_links;   // the links that the chain's joints move
  std::set<std::string> carried_links;  // those of them that another link carries
};
// Writes which chain was chosen into model.reading, and a note about a proposed tip.
void add_choice(const UrdfChain& chain, RobotModel& model);
// Returns the note about a joint that is not on the chain. `mass_kg` hangs on it; `carrier` is the
// body that carries it: 0 is the base, i the link that joint i - 1 of the model moves.
std::string describe_held(const RobotModel& model, const std::string& joint,
                          const std::string& held_at, double mass_kg, std::size_t carrier);
// Returns the root. Checks that the links form a tree.
const UrdfLink& find_root(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                          const std::string& name);
// Returns the chain that `options` selects. Checks that the links form a tree with one root. Throws
// RobotOptionError as load_urdf() does, also if no joint between base and tip can move.
UrdfChain choose_chain(const std::vector<UrdfLink>& links, const std::vector<UrdfJoint>& joints,
                       const RobotOptions& options, const std::string& name);

// The checked mass and shapes of a link.
struct UrdfBody {
  std::optional<Inertial> inertial;  // in the link's frame
  std::vector<VisualShape> shapes;   // poses in the link's frame
  std::string unshown;               // why a shape is left out that may have a volume
  bool has_faults = false;           // the inertial could not be read
  std::size_t zero_inertial = 0;     // the number of an <inertial> of zeros; 0: there is none
};

// A joint's origin, and its motion if it is part of the chain.
struct UrdfPlacement {
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // in the parent link's frame
  // For a joint of the chain: its kind, axis and limits, as in RobotModel. `motion.origin` is
  // unused.
  Joint motion;
  // For a movable joint outside the chain: the pose at which it is held, relative to its origin,
  // and the held position as text ("0 m").
  Eigen::Isometry3d held_pose = Eigen::Isometry3d::Identity();
  std::string held_at;  // empty: the joint is fixed or part of the chain
};

// A validated URDF, with links and joints in the file's order.
struct CheckedUrdf {
  std::string name;  // of the robot
  UrdfChain chain;
  std::vector<UrdfLink> links;
  std::vector<UrdfBody> bodies;  // one per link
  std::vector<UrdfJoint> joints;
  std::vector<UrdfPlacement> placements;  // one per joint
  std::vector<std::string> notes;
  UrdfRepairs repairs;
};

// Calls scan_urdf(), then reads and validates every part of the file that armwright uses. Throws
// for text that is not XML and for links and joints that are no tree. Other faults go to `faults`;
// then the result is not a robot.
CheckedUrdf check_urdf(std::string_view xml, const std::string& name, const RobotOptions& options,
                       UrdfFaults& faults);

// Builds the model: joins links that do not move relative to each other, and computes missing
// masses from the density, or assumes them with `options.repair`. Moving links without mass go to
// `faults`. Searches meshes from the folder of the file `name`.
RobotModel build_model(const CheckedUrdf& checked, const std::string& name,
                       const RobotOptions& options, UrdfFaults& faults);

// Returns the <inertia> and the <inertial> of a body, with all digits of its numbers.
std::string write_inertia(const Eigen::Matrix3d& tensor);
std::string write_inertial(const Inertial& body);

}  // namespace armwright
