// Tests where meshes are looked for. The folders resemble a workspace of ROS.
#include "sim/robot/mesh_finder.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;

class MeshFinding : public testing::Test {
 protected:
  MeshFinding() {
    unsetenv("AMENT_PREFIX_PATH");
    unsetenv("ROS_PACKAGE_PATH");
    fs::create_directories(path("ws/src/arm_support/urdf"));
  }
  ~MeshFinding() override {
    unsetenv("AMENT_PREFIX_PATH");
    unsetenv("ROS_PACKAGE_PATH");
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text = "") const {
    fs::create_directories(path(name).parent_path());
    std::ofstream(path(name)) << text;
  }
  void write_package(const std::string& folder, const std::string& name) const {
    write(folder + "/package.xml",
          "<?xml version=\"1.0\"?><package><name>\n  " + name + "\n</name></package>");
  }
  // Returns where the mesh is found for a description in ws/src/arm_support/urdf, relative to the
  // test's folder; "" if it is not found.
  std::string find(const std::string& name,
                   const std::map<std::string, fs::path>& packages = {}) const {
    MeshFinder finder(path("ws/src/arm_support/urdf"), packages);
    const auto found = finder.find(name);
    return found ? fs::relative(*found, folder_.path()).string() : "";
  }

  TemporaryFolder folder_;
};

TEST_F(MeshFinding, FollowsTheNamesOfFolders) {
  write("ws/src/arm_support/meshes/a.stl");
  EXPECT_EQ(find("package://arm_support/meshes/a.stl"), "ws/src/arm_support/meshes/a.stl");
  EXPECT_EQ(find("../meshes/a.stl"), "ws/src/arm_support/meshes/a.stl");
  EXPECT_EQ(find("meshes/a.stl"), "ws/src/arm_support/meshes/a.stl");
  EXPECT_EQ(find("file://" + path("ws/src/arm_support/meshes/a.stl").string()),
            "ws/src/arm_support/meshes/a.stl");
  EXPECT_EQ(find("package://arm_support/meshes/b.stl"), "");
  EXPECT_EQ(find("package://"), "");
}

// The folder of the package has another name than the package: above, beside, and one level lower.
TEST_F(MeshFinding, FollowsTheNamesInPackageXml) {
  write_package("ws/src/arm_support", "official_arm_support");
  write("ws/src/arm_support/meshes/a.stl");
  EXPECT_EQ(find("package://official_arm_support/meshes/a.stl"), "ws/src/arm_support/meshes/a.stl");
  write_package("ws/src/gripper", "official_gripper");
  write("ws/src/gripper/meshes/g.stl");
  EXPECT_EQ(find("package://official_gripper/meshes/g.stl"), "ws/src/gripper/meshes/g.stl");
  write_package("ws/src/sensors/camera", "official_camera");
  write("ws/src/sensors/camera/c.stl");
  EXPECT_EQ(find("package://official_camera/c.stl"), "ws/src/sensors/camera/c.stl");
}

TEST_F(MeshFinding, TakesTheFolderThatTheUserNames) {
  write("elsewhere/a.stl");
  write("ws/src/arm_support/a.stl");
  EXPECT_EQ(find("package://arm_support/a.stl", {{"arm_support", path("elsewhere")}}),
            "elsewhere/a.stl");
  EXPECT_EQ(find("package://arm_support/a.stl", {{"other", path("elsewhere")}}),
            "ws/src/arm_support/a.stl");
}

TEST_F(MeshFinding, FollowsThePathsOfBothGenerationsOfRos) {
  write("opt/two/share/arm_description/a.stl");
  setenv("AMENT_PREFIX_PATH", (path("opt/one").string() + ":" + path("opt/two").string()).c_str(),
         1);
  EXPECT_EQ(find("package://arm_description/a.stl"), "opt/two/share/arm_description/a.stl");
  write_package("catkin/src/vendor/robots/folder", "old_description");
  write("catkin/src/vendor/robots/folder/o.stl");
  setenv("ROS_PACKAGE_PATH", (path("nothing").string() + ":" + path("catkin/src").string()).c_str(),
         1);
  EXPECT_EQ(find("package://old_description/o.stl"), "catkin/src/vendor/robots/folder/o.stl");
}

TEST_F(MeshFinding, LooksIntoNoFolderInsideAPackage) {
  write_package("catkin/src/outer", "outer");
  write_package("catkin/src/outer/inner", "inner");
  write("catkin/src/outer/inner/i.stl");
  setenv("ROS_PACKAGE_PATH", path("catkin/src").c_str(), 1);
  EXPECT_EQ(find("package://inner/i.stl"), "");
}

TEST_F(MeshFinding, SurvivesDamagedPackages) {
  write("ws/src/bad/package.xml", "<package><name>bad</na");
  write("ws/src/empty/package.xml");
  write("ws/src/nameless/package.xml", "<package><name/></package>");
  write_package("ws/src/good", "the_good");
  write("ws/src/good/g.stl");
  EXPECT_EQ(find("package://the_good/g.stl"), "ws/src/good/g.stl");
}

TEST(MeshFinder, ReadsPackagesOfTheUser) {
  EXPECT_EQ(parse_package("arm=/opt/a=b")->first, "arm");
  EXPECT_EQ(parse_package("arm=/opt/a=b")->second, "/opt/a=b");
  for (const char* text : {"", "arm", "arm=", "=/opt"}) {
    EXPECT_EQ(parse_package(text), std::nullopt) << text;
  }
}

TEST(MeshFinder, DescribesWhatIsMissing) {
  EXPECT_EQ(describe_missing_meshes(10, "package://arm/a.stl"),
            "10 meshes were not found, e.g. package://arm/a.stl; --package NAME=DIR "
            "(robot.packages) says where a package is");
  EXPECT_THAT(describe_missing_meshes(1, "a\x1b"),
              testing::StartsWith("1 mesh was not found, e.g. a?;"));
}

}  // namespace
}  // namespace armwright
