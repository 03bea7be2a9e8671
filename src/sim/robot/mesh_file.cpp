#include "sim/robot/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

#ifdef ARMWRIGHT_WITH_ASSIMP
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#endif

namespace armwright {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::bad_data, fmt::format("{}: {}", sanitize(file.string()), what));
}

#ifdef ARMWRIGHT_WITH_ASSIMP

// Refuses to open any other file (materials, textures, parts). Only shapes are needed, and a mesh
// from an untrusted source must not make armwright read files that it names.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

std::string find_format(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  if (ending != ".stl" && ending != ".obj" && ending != ".dae") {
    fail(file, "this type of file is not a mesh; allowed are .stl, .obj and .dae");
  }
  return ending.substr(1);
}

void append(TriangleMesh& mesh, const aiMesh& part, const std::filesystem::path& file) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& vertex = part.mVertices[i];
    for (const float value : {vertex.x, vertex.y, vertex.z}) {
      if (!std::isfinite(value)) {
        fail(file, "a vertex is not finite");
      }
      mesh.positions.push_back(value);
    }
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) {
      continue;  // a point or a line has no area
    }
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= part.mNumVertices) {
        fail(file, "a triangle refers to a vertex that does not exist");
      }
      mesh.indices.push_back(first + face.mIndices[k]);
    }
  }
}

#endif

}  // namespace

#ifdef ARMWRIGHT_WITH_ASSIMP

bool can_read_meshes() {
  return true;
}

TriangleMesh read_mesh(const std::filesystem::path& file) {
  const std::string format = find_format(file);
  const std::string content = read_file(file, kMeshFileLimit_bytes);
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // the importer deletes it
  // URDF uses a mesh in the file's own axes and ignores Collada's up axis.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(
      AI_CONFIG_PP_RVC_FLAGS,
      aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
          aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
          aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS);
  const aiScene* scene = importer.ReadFileFromMemory(
      content.data(), content.size(),
      aiProcess_Triangulate | aiProcess_RemoveComponent | aiProcess_PreTransformVertices |
          aiProcess_JoinIdenticalVertices,
      format.c_str());
  if (scene == nullptr) {
    fail(file, sanitize(importer.GetErrorString()));
  }
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    append(mesh, *scene->mMeshes[i], file);
  }
  if (mesh.indices.empty()) {
    fail(file, "it has no triangles");
  }
  return mesh;
}

#else

bool can_read_meshes() {
  return false;
}

TriangleMesh read_mesh(const std::filesystem::path& file) {
  fail(file, "this program was built without Assimp, which reads meshes");
}

#endif

}  // namespace armwright
