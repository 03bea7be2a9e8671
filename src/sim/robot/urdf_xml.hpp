// Strict reading of XML elements for urdf_check*.cpp: every refusal names file, line, link or
// joint, element and attribute.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace armwright {

// The beginning of a text from a file, fit for a message.
std::string shorten(std::string_view text);

class UrdfXml {
 public:
  // `name` is the file's in messages.
  explicit UrdfXml(std::string name) : name_(std::move(name)) {}

  // What messages call the link or joint at hand: "link 'link_1'".
  void set_context(std::string where) { where_ = std::move(where); }
  [[noreturn]] void fail(const tinyxml2::XMLElement& element, const std::string& what) const;

  // Refuses what looks like a misspelt name of a child or attribute, and xacro. Other extensions of
  // URDF pass; they stay unread.
  void check_names(const tinyxml2::XMLElement& element, const std::vector<std::string>& children,
                   const std::vector<std::string>& attributes) const;

  // The only child of that name; refuses a second one. find_only(): null if there is none,
  // get_only(): refuses that too.
  const tinyxml2::XMLElement* find_only(const tinyxml2::XMLElement& parent,
                                        const char* child_name) const;
  const tinyxml2::XMLElement& get_only(const tinyxml2::XMLElement& parent, const char* child_name,
                                       const char* hint) const;

  // An attribute's text: present, not empty, printable.
  std::string get_text(const tinyxml2::XMLElement& element, const char* attribute) const;

  // An attribute's `count` finite numbers, `fallback` where it is absent (no fallback: it must be
  // there).
  std::vector<double> read_numbers(const tinyxml2::XMLElement& element, const char* attribute,
                                   std::size_t count,
                                   const std::vector<double>& fallback = {}) const;
  double read_number(const tinyxml2::XMLElement& element, const char* attribute) const;
  double read_number(const tinyxml2::XMLElement& element, const char* attribute,
                     double fallback) const;
  double read_positive(const tinyxml2::XMLElement& element, const char* attribute) const;

 private:
  void check_spelling(const tinyxml2::XMLElement& at, const std::string& what,
                      const std::string& found, const std::vector<std::string>& valid) const;
  void refuse_xacro(const tinyxml2::XMLElement& element, const char* attribute,
                    std::string_view text) const;

  std::string name_;
  std::string where_ = "the file";
};

}  // namespace armwright
