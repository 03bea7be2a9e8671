// Compiles a prepared MJCF file, and finds the masses that meshes decide.

#ifdef ARMWRIGHT_WITH_MUJOCO

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>

#include "base/file.hpp"
#include "base/text.hpp"
#include "sim/robot/mesh_file.hpp"
#include "sim/robot/mesh_finder.hpp"
#include "sim/robot/mjcf_parts.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

constexpr const char* kMainFile = "arm.xml";

// Returns a tetrahedron as OBJ. The library takes its corners in the order of the faces.
std::string make_stand_in(double edge_m) {
  return fmt::format(
      "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", edge_m);
}

// Throws the library's message with the place in the user's file in place of the line in `xml`.
[[noreturn]] void fail_compile(const MjcfText& text, const std::string& name,
                               const std::string& message) {
  static const std::regex kLine(",? *line (?:= )?([0-9]+)(?:, column (?:= )?-?[0-9]+)?");
  static const std::regex kBlanks("\\s+");
  MjcfPlace place{name, 1};
  std::smatch found;
  if (std::regex_search(message, found, kLine)) {
    const std::size_t line = std::stoul(found.str(1).substr(0, 9));
    if (line >= 1 && line <= text.places.size()) {
      place = text.places[line - 1];
    }
  }
  std::string what = std::regex_replace(std::regex_replace(message, kLine, ""), kBlanks, " ");
  what.erase(what.find_last_not_of(' ') + 1);
  fail_urdf(place.file, place.line,
            fmt::format("MuJoCo {} does not take the file: {}; change or remove what it names",
                        mj_versionString(), sanitize(what)));
}

// The files that stand for the meshes, by the name of the mesh in MjcfText::xml.
using MeshContents = std::map<std::string, std::string>;

MujocoModelHandle compile_with(const MjcfText& text, const std::string& name,
                               const std::string& xml, MeshContents meshes) {
  meshes[kMainFile] = xml;
  std::string message;
  MujocoModelHandle model = compile_mjcf(kMainFile, meshes, message);
  if (model == nullptr) {
    fail_compile(text, name, message);
  }
  return model;
}

MujocoModelHandle compile_with_stand_ins(const MjcfText& text, const std::string& name,
                                         double edge_m) {
  MeshContents meshes;
  for (std::size_t i = 0; i < text.meshes.size(); ++i) {
    meshes[make_mesh_name(i)] = make_stand_in(edge_m);
  }
  return compile_with(text, name, text.xml, std::move(meshes));
}

struct Masses {
  mjtNum* values;
  std::size_t per_body;
};
std::vector<Masses> list_masses(const mjModel& model) {
  return {
      {model.body_mass, 1}, {model.body_inertia, 3}, {model.body_ipos, 3}, {model.body_iquat, 4}};
}

// Returns the bodies whose mass properties differ in any bit.
std::set<int> find_differences(const mjModel& a, const mjModel& b,
                               const std::function<bool(int)>& moves) {
  std::set<int> bodies;
  const auto masses = list_masses(a), others = list_masses(b);
  for (std::size_t part = 0; part < masses.size(); ++part) {
    const std::size_t width = masses[part].per_body;
    for (int body = 0; body < a.nbody; ++body) {
      const std::size_t at = width * static_cast<std::size_t>(body);
      if (moves(body) && !std::equal(masses[part].values + at, masses[part].values + at + width,
                                     others[part].values + at)) {
        bodies.insert(body);
      }
    }
  }
  return bodies;
}

// Returns the meshes of the bodies, and those that give a primitive shape its size: the library
// does not say of which body.
std::set<int> find_meshes(const mjModel& model, const std::set<int>& bodies) {
  std::set<int> unseen, found;
  for (int mesh = 0; mesh < model.nmesh; ++mesh) {
    unseen.insert(mesh);
  }
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (model.geom_type[geom] == mjGEOM_MESH) {
      unseen.erase(model.geom_dataid[geom]);
      if (bodies.contains(model.geom_bodyid[geom])) {
        found.insert(model.geom_dataid[geom]);
      }
    }
  }
  found.merge(unseen);
  return found;
}

std::string to_lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

}  // namespace

std::string CompiledMjcf::body_name(int body) const {
  const char* found = mj_id2name(model.get(), mjOBJ_BODY, body);
  return found != nullptr ? found : fmt::format("body #{}", body);
}

std::string CompiledMjcf::joint_name(int joint) const {
  const char* found = mj_id2name(model.get(), mjOBJ_JOINT, joint);
  return found != nullptr ? found : fmt::format("joint #{}", joint);
}

void CompiledMjcf::fail_body(int body, const std::string& what) const {
  const auto found = text.bodies.find(body_name(body));
  const MjcfPlace place = found == text.bodies.end() ? MjcfPlace{name} : found->second;
  fail_urdf(place.file, place.line, fmt::format("body '{}': {}", body_name(body), what));
}

void CompiledMjcf::fail_joint(int joint, const std::string& what) const {
  const auto found = text.joints.find(joint_name(joint));
  if (found == text.joints.end()) {
    fail_body(model->jnt_bodyid[joint], fmt::format("{}: {}", joint_name(joint), what));
  }
  fail_urdf(found->second.file, found->second.line,
            fmt::format("joint '{}': {}", joint_name(joint), what));
}

CompiledMjcf compile_prepared(MjcfText text, const std::string& name) {
  MujocoModelHandle model = compile_with_stand_ins(text, name, kStandInEdge_m);
  return {name, std::move(text), std::move(model)};
}

std::map<std::string, std::filesystem::path> load_mesh_masses(
    CompiledMjcf& mjcf, const std::map<std::string, std::filesystem::path>& packages,
    const std::function<bool(int)>& moves) {
  const MjcfText& text = mjcf.text;
  std::map<std::string, std::filesystem::path> files;
  if (text.meshes.empty()) {
    return files;
  }
  // A mass that does not change with the size of the stand-ins needs no mesh.
  const MujocoModelHandle other = compile_with_stand_ins(text, mjcf.name, 2 * kStandInEdge_m);
  const std::set<int> bodies = find_differences(*mjcf.model, *other, moves);
  if (bodies.empty()) {
    return files;
  }
  MeshFinder finder(std::filesystem::path(mjcf.name).parent_path(), packages);
  const std::set<int> needed = find_meshes(*mjcf.model, bodies);
  std::string xml = text.xml;
  MeshContents some, others;  // stand-ins of two sizes for what is missing
  std::string missing;
  for (std::size_t i = 0; i < text.meshes.size(); ++i) {
    const auto& [mesh_name, file] = text.meshes[i];
    const std::string stand_in = make_mesh_name(i);
    some[stand_in] = make_stand_in(kStandInEdge_m);
    others[stand_in] = make_stand_in(2 * kStandInEdge_m);
    if (!needed.contains(mj_name2id(mjcf.model.get(), mjOBJ_MESH, mesh_name.c_str()))) {
      continue;
    }
    const auto path = finder.find(file);
    if (!path) {
      missing += fmt::format("{}'{}'", missing.empty() ? "" : ", ", file);
      continue;
    }
    const std::string real = make_mesh_name(i, to_lower(path->extension().string()));
    const std::string content = read_file(*path, kMeshFileLimit_bytes);
    const std::string mark = fmt::format("\"{}\"", stand_in);
    xml.replace(xml.find(mark), mark.size(), fmt::format("\"{}\"", real));
    some[real] = others[real] = content;
    files[file] = *path;
  }
  const MujocoModelHandle model = compile_with(text, mjcf.name, xml, some);
  if (!missing.empty()) {
    const auto unknown =
        find_differences(*model, *compile_with(text, mjcf.name, xml, std::move(others)), moves);
    if (!unknown.empty()) {
      mjcf.fail_body(*unknown.begin(),
                     fmt::format("its mass comes from meshes, and there is no file {}; put it "
                                 "there, or give the body an <inertial>",
                                 missing));
    }
  }
  const auto from = list_masses(*model), to = list_masses(*mjcf.model);
  for (std::size_t part = 0; part < from.size(); ++part) {
    std::copy_n(from[part].values, from[part].per_body * static_cast<std::size_t>(model->nbody),
                to[part].values);
  }
  return files;
}

}  // namespace armwright

#endif
