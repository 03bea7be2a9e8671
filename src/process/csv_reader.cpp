#include "process/csv_reader.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// Removes the apostrophe that quote_csv() puts before text that a spreadsheet would take for a
// formula.
std::string strip_apostrophe(std::string field) {
  if (field.starts_with('\'') && begins_as_formula(std::string_view(field).substr(1))) {
    field.erase(0, 1);
  }
  return field;
}

}  // namespace

std::string CsvReader::read_field() {
  if (!rest_.starts_with('"')) {
    const std::string_view field = rest_.substr(0, rest_.find_first_of(",\r\n"));
    if (field.find('"') != std::string_view::npos) {
      throw Error(ErrorKind::bad_data, "a quote amid a field");
    }
    rest_.remove_prefix(field.size());
    return std::string(field);
  }
  std::string field;
  while (true) {
    rest_.remove_prefix(1);
    const std::size_t quote = rest_.find('"');
    if (quote == std::string_view::npos) {
      throw Error(ErrorKind::bad_data, "a quote is not closed");
    }
    field += rest_.substr(0, quote);
    rest_.remove_prefix(quote + 1);
    if (!rest_.starts_with('"')) {
      break;
    }
    field += '"';
  }
  if (!rest_.empty() && std::string_view(",\r\n").find(rest_.front()) == std::string_view::npos) {
    throw Error(ErrorKind::bad_data, "text behind a closing quote");
  }
  return field;
}

bool CsvReader::read_row(std::vector<std::string>& fields) {
  fields.clear();
  if (rest_.empty()) {
    return false;
  }
  ++row_;
  while (true) {
    fields.push_back(strip_apostrophe(read_field()));
    if (!rest_.starts_with(',')) {
      break;
    }
    rest_.remove_prefix(1);
  }
  if (rest_.starts_with("\r\n")) {
    rest_.remove_prefix(1);
  }
  if (!rest_.empty()) {
    rest_.remove_prefix(1);
  }
  return true;
}

}  // namespace armwright
