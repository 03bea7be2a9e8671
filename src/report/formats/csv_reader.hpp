// CSV as quote_csv() writes it (RFC 4180), row by row.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace armwright {

class CsvReader {
 public:
  explicit CsvReader(std::string_view text) : rest_(text) {}
  // False at the end. Error{bad_data} for a quote that is not closed or stands amid a field; the
  // caller knows the file, and row() the place.
  bool read_row(std::vector<std::string>& fields);
  std::size_t row() const { return row_; }  // which was read last or failed, from 1

 private:
  std::string read_field();
  std::string_view rest_;
  std::size_t row_ = 0;
};

}  // namespace armwright
