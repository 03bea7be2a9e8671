// Prepares the text of an MJCF file for the library: inserts included files and leaves out what
// armwright does not use.

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <list>
#include <set>

#include "base/file.hpp"
#include "base/text.hpp"
#include "sim/robot/mjcf.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {

using tinyxml2::XMLElement;

namespace {

using Words = std::set<std::string_view>;

// Sections that change neither masses nor joints. Newer versions of MuJoCo have attributes in them
// that the library does not know.
const Words kUnusedSections = {"visual",  "statistic", "sensor",     "keyframe", "custom",
                               "contact", "size",      "deformable", "plugin"};
// Elements that are left out wherever they stand.
const Words kUnusedElements = {"camera", "light", "texture", "skin", "pair", "lengthrange"};
// Attributes that are left out of all elements: folders of files, names of textures, users' own
// data, gains of servos, and others that only newer versions know.
const Words kUnusedAttributes = {"actuatorfrclimited",
                                 "actuatorgravcomp",
                                 "align",
                                 "alignfree",
                                 "assetdir",
                                 "content_type",
                                 "convexhull",
                                 "dampratio",
                                 "delay",
                                 "discardvisual",
                                 "fusestatic",
                                 "gravcomp",
                                 "inheritrange",
                                 "kv",
                                 "maxhullvert",
                                 "meshdir",
                                 "nsample",
                                 "saveinertial",
                                 "sleep",
                                 "strippath",
                                 "texture",
                                 "texturedir",
                                 "timeconst",
                                 "usethread",
                                 "user"};
// All that these elements keep.
const std::map<std::string_view, Words> kUsedAttributes = {
    {"option", {"gravity"}}, {"flag", {"gravity"}}, {"material", {"name", "class", "rgba"}}};
constexpr std::size_t kIncludeLimit = 1000;
constexpr std::size_t kMeshLimit = 1000;

std::string escape(std::string_view value) {
  std::string text;
  for (const char c : value) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return text;
}

class Preparation {
 public:
  explicit Preparation(const std::string& name)
      : folder_(std::filesystem::path(name).parent_path()), open_{name} {}

  MjcfText prepare(std::string_view xml, const std::string& name) {
    const XMLElement& root = parse(xml, name);
    const char* model = root.Attribute("model");
    // Since version 3, a range alone limits a joint or an actuator. Version 2.2 refuses such a file
    // unless the compiler is told so.
    open("mujoco", model == nullptr ? "" : fmt::format(" model=\"{}\"", escape(model)), {name, 1});
    // This model is never simulated, so it needs no memory for contacts.
    add_line(
        "<compiler autolimits=\"true\"/><size njmax=\"0\" nconmax=\"0\"/><option><flag "
        "constraint=\"disable\" contact=\"disable\"/></option>",
        {name, 1});
    write_children(root, name, 1);
    add_line("</mujoco>", {name, 1});
    for (MjcfMesh& mesh : text_.meshes) {
      const std::filesystem::path path(mesh.file);
      mesh.file = ((mesh_folder_.empty() ? asset_folder_ : mesh_folder_) /
                   (strips_paths_ ? path.filename() : path))
                      .string();
    }
    if (!floating_.empty()) {
      text_.notes.push_back(
          fmt::format("gravcomp is left out: gravity acts on {}", join(floating_, ", ")));
    }
    return std::move(text_);
  }

 private:
  [[noreturn]] static void fail(const XMLElement& element, const std::string& file,
                                const std::string& what) {
    fail_urdf(file, element.GetLineNum(), what);
  }

  const XMLElement& parse(std::string_view xml, const std::string& file) {
    bytes_ += xml.size();
    if (bytes_ > kUrdfLimit_bytes) {
      fail_urdf(file, 1,
                fmt::format("the file and the files that it includes have more than {} bytes",
                            kUrdfLimit_bytes));
    }
    scan_urdf(xml, file);
    tinyxml2::XMLDocument& document = documents_.emplace_back();
    if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS ||
        document.RootElement() == nullptr) {
      fail_urdf(file, std::max(1, document.ErrorLineNum()),
                fmt::format("is not well-formed XML: {}", document.ErrorName()));
    }
    return *document.RootElement();
  }

  void add_line(std::string_view line, const MjcfPlace& place) {
    text_.xml += line;
    text_.xml += '\n';
    text_.places.push_back(place);
  }

  void open(std::string_view tag, const std::string& attributes, const MjcfPlace& place) {
    add_line(fmt::format("<{}{}>", tag, attributes), place);
  }

  void write_children(const XMLElement& parent, const std::string& file, std::size_t depth) {
    for (const XMLElement* child = parent.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      write(*child, parent.Name(), file, depth);
    }
  }

  // `parent` is the name of the element that contains this one.
  void write(const XMLElement& element, std::string_view parent, const std::string& file,
             std::size_t depth) {
    const std::string_view tag = element.Name();
    if (++elements_ > kUrdfElementLimit || depth > kUrdfDepthLimit) {
      fail(element, file,
           fmt::format("with its included files, the file has more than {} elements, or elements "
                       "nested deeper than {}",
                       kUrdfElementLimit, kUrdfDepthLimit));
    }
    if (tag == "include") {
      include(element, parent, file, depth);
      return;
    }
    if (tag == "composite") {
      fail(element, file,
           "<composite> makes bodies by the thousand, which no arm needs; remove it, or give "
           "armwright the file of the arm alone");
    }
    if (kUnusedElements.contains(tag) || (parent == "mujoco" && kUnusedSections.contains(tag)) ||
        parent == "material" || (parent == "option" && tag != "flag")) {
      return;
    }
    const MjcfPlace place{file, element.GetLineNum()};
    note(element, tag, parent, place);
    std::string attributes = write_attributes(element, tag, place);
    if (tag == "position" && parent == "actuator") {
      attributes += " ctrllimited=\"false\"";  // its range may come from inheritrange
    }
    open(tag, attributes, place);
    write_children(element, file, depth + 1);
    add_line(fmt::format("</{}>", tag), place);
  }

  // Inserts the children of the included file's root, whatever its name.
  void include(const XMLElement& element, std::string_view parent, const std::string& file,
               std::size_t depth) {
    const char* name = element.Attribute("file");
    if (name == nullptr) {
      fail(element, file, "<include> has no file; it must name one");
    }
    if (sanitize(name) != name) {
      fail(element, file, "<include>: file must be printable UTF-8");
    }
    const std::filesystem::path path = folder_ / name;
    if (std::ranges::find(open_, path) != open_.end() || ++includes_ > kIncludeLimit) {
      fail(element, file,
           fmt::format("<include> of '{}': a file cannot include itself, and at most {} <include> "
                       "are allowed",
                       name, kIncludeLimit));
    }
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      fail(element, file,
           fmt::format("<include>: there is no file '{}'; put it beside the file that includes it",
                       path.string()));
    }
    const std::string& content = contents_.emplace_back(read_file(path, kUrdfLimit_bytes));
    const XMLElement& root = parse(content, path.string());
    text_.included.emplace(name, path);
    open_.push_back(path);
    for (const XMLElement* child = root.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      write(*child, parent, path.string(), depth + 1);
    }
    open_.pop_back();
  }

  // Keeps what messages and the reader need of an element.
  void note(const XMLElement& element, std::string_view tag, std::string_view parent,
            const MjcfPlace& place) {
    const char* name = element.Attribute("name");
    if (name != nullptr &&
        (sanitize(name) != name || std::string_view(name).size() > kUrdfTextLimit_bytes)) {
      fail(element, place.file,
           fmt::format("<{}>: name must be printable UTF-8 of at most {} bytes", sanitize(tag),
                       kUrdfTextLimit_bytes));
    }
    if (name != nullptr && tag == "body") {
      text_.bodies.emplace(name, place);
    } else if (name != nullptr && parent == "body" && (tag == "joint" || tag == "freejoint")) {
      text_.joints.emplace(name, place);
    } else if (parent == "equality") {
      text_.equalities.push_back(place);
    } else if (parent == "tendon") {
      text_.tendons.push_back(place);
    } else if (tag == "compiler") {
      read_folders(element);
    }
    if (tag == "body" && element.DoubleAttribute("gravcomp", 0) != 0) {
      floating_.push_back(name == nullptr ? "a body" : fmt::format("'{}'", name));
    }
  }

  void read_folders(const XMLElement& compiler) {
    const auto read = [&](const char* attribute, std::filesystem::path& folder) {
      if (const char* value = compiler.Attribute(attribute)) {
        folder = value;
      }
    };
    read("assetdir", asset_folder_);
    read("meshdir", mesh_folder_);
    compiler.QueryBoolAttribute("strippath", &strips_paths_);
  }

  std::string write_attributes(const XMLElement& element, std::string_view tag,
                               const MjcfPlace& place) {
    const auto used = kUsedAttributes.find(tag);
    const bool is_tendon = tag == "spatial" || tag == "fixed";
    const char* file = element.Attribute("file");
    std::string text;
    for (const tinyxml2::XMLAttribute* attribute = element.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next()) {
      std::string_view name = attribute->Name();
      std::string value = attribute->Value();
      if (name.starts_with("file")) {  // the library must not open files
        continue;
      }
      if (kUnusedAttributes.contains(name) ||
          (used != kUsedAttributes.end() && !used->second.contains(name)) ||
          (is_tendon && (name == "armature" || name == "actuatorfrcrange")) ||
          (tag == "position" && name == "ctrllimited")) {
        continue;
      }
      if (name == "actuatorfrcrange") {
        // A joint's own data of this name pass through the library with the classes resolved.
        if (element.Attribute("actuatorfrclimited", "false") != nullptr) {
          continue;
        }
        name = "user";
      }
      text += fmt::format(" {}=\"{}\"", name, escape(value));
    }
    if (tag == "hfield") {
      text += " nrow=\"2\" ncol=\"2\"";  // a height field has no mass
    }
    if (file == nullptr || (tag != "mesh" && tag != "hfield")) {
      return text;
    }
    std::string name = std::filesystem::path(file).stem().string();  // unless it has its own
    if (const char* own = element.Attribute("name")) {
      name = own;
    } else {
      text += fmt::format(" name=\"{}\"", escape(name));
    }
    if (tag == "hfield") {
      return text;
    }
    text += fmt::format(" file=\"{}\"", make_mesh_name(text_.meshes.size()));
    text_.meshes.push_back({std::move(name), file});
    if (text_.meshes.size() > kMeshLimit || sanitize(file) != file) {
      fail_urdf(place.file, place.line,
                fmt::format("<mesh>: file must be printable UTF-8, and at most {} meshes are "
                            "allowed",
                            kMeshLimit));
    }
    return text;
  }

  std::filesystem::path folder_;
  std::filesystem::path asset_folder_, mesh_folder_;
  bool strips_paths_ = false;
  std::list<tinyxml2::XMLDocument> documents_;
  std::list<std::string> contents_;
  std::vector<std::filesystem::path> open_;  // files, each included in the one before
  std::size_t bytes_ = 0, elements_ = 0, includes_ = 0;
  std::vector<std::string> floating_;  // bodies with gravity compensation
  MjcfText text_;
};

}  // namespace

std::string make_mesh_name(std::size_t mesh, std::string_view ending) {
  return fmt::format("armwright-mesh-{}{}", mesh, ending);
}

MjcfText prepare_mjcf(std::string_view xml, const std::string& name) {
  return Preparation(name).prepare(xml, name);
}

}  // namespace armwright
