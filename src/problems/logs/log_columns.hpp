// Finds out which column of a file is which quantity of which joint, from its name and the options.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/logs/recording.hpp"

namespace armwright {

// The columns that a table needs, by their place in its header. `columns` have no values yet.
struct LogLayout {
  std::size_t time = 0;
  double time_factor_s = 1;
  std::string time_name;
  std::vector<RecordedColumn> columns;
  std::vector<std::size_t> places;  // of `columns`
};

// The robot's joints and the options, as far as all formats share them. Keeps references to both.
class LogColumns {
 public:
  // Throws Error{usage} if an option names a joint or a quantity that does not exist.
  LogColumns(const RobotModel& robot, const LogOptions& options);

  // Finds the columns of a table. Throws Error{bad_data} "WHERE: ..." if one is missing or two
  // fit, and Error{usage} if an option names a column that the header lacks.
  LogLayout match(const std::vector<std::string>& header, const std::string& where) const;

  // Returns the joint's name in the file.
  const std::string& file_name(Eigen::Index joint) const;
  // Returns the factor from the file's unit to SI and to the joint's side of the gear. `unit` is the
  // unit that the column's name has, or empty. Throws Error{bad_data} "WHERE: ..." for a unit that
  // does not fit the joint and for a motor torque without a gear ratio.
  double calc_factor(LogQuantity quantity, Eigen::Index joint, bool is_motor, std::string_view unit,
                     const std::string& column, const std::string& where) const;

  const RobotModel& robot() const { return robot_; }
  const LogOptions& options() const { return options_; }

 private:
  struct Meaning {
    LogQuantity quantity;
    Eigen::Index joint;
    bool is_motor;
    std::string unit;
  };

  std::optional<Eigen::Index> find_joint(std::string_view text) const;
  std::optional<Meaning> read_meaning(std::string_view text) const;
  std::optional<Meaning> guess_meaning(const std::string& column) const;
  std::string find_unit(LogQuantity quantity, Eigen::Index joint) const;
  const double* find_number(const std::map<std::string, double>& numbers, Eigen::Index joint) const;
  std::size_t find_column(const std::vector<std::string>& header, const std::string& key,
                          const std::string& where) const;
  std::optional<std::size_t> find_time(const std::vector<std::string>& header,
                                       const std::string& where, double& factor_s) const;

  const RobotModel& robot_;
  const LogOptions& options_;
  std::map<std::string, Eigen::Index, std::less<>> joints_;  // by number and by normalized name
};

}  // namespace armwright
