// Reads CSV (RFC 4180) as quote_csv() writes it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// A reader that returns one row per call. The text must outlive it.
class CsvReader {
 public:
  explicit CsvReader(std::string_view text) : rest_(text) {}
  // Returns false at the end of the text. Throws Error{bad_data} for a quote that is not closed or
  // stands inside a field. The message names no file; the caller adds the file and row().
  bool read_row(std::vector<std::string>& fields);
  // Returns the number of the row that was read last or could not be read, from 1.
  std::size_t row() const { return row_; }

 private:
  std::string read_field();
  std::string_view rest_;
  std::size_t row_ = 0;
};

}  // namespace armwright
