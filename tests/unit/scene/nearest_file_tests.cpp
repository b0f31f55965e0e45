// Which file was meant, in a tree such as people have: a scene, meshes beside it, a slip in the
// name.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "scene/nearest_file.h"

namespace sutura {
namespace {

class NearestFile : public testing::Test {
 protected:
  NearestFile()
      : root_(std::filesystem::path(testing::TempDir()) /
              ("sutura_nearest_" + std::to_string(::getpid()))) {
    for (const char* file : {"scenes/a.xml", "meshes/pad.msh", "meshes/block.msh",
                             "scenes/data/path.csv", "scenes/own/liver.vtu"}) {
      std::filesystem::create_directories((root_ / file).parent_path());
      std::ofstream(root_ / file) << "x";
    }
  }
  ~NearestFile() override { std::filesystem::remove_all(root_); }
  std::string near(const std::string& file) const { return nearest_file(root_ / "scenes", file); }
  std::filesystem::path root_;
};

TEST_F(NearestFile, MendsSlips) {
  EXPECT_EQ(near("../meshes/padd.msh"), "../meshes/pad.msh");    // in the name
  EXPECT_EQ(near("../meshes/PAD.msh"), "../meshes/pad.msh");     // in the case
  EXPECT_EQ(near("../mesh/pad.msh"), "../meshes/pad.msh");       // in the folder
  EXPECT_EQ(near("../mehses/blok.msh"), "../meshes/block.msh");  // in both
  EXPECT_EQ(near("../meshes/pad.vtk"), "../meshes/pad.msh");     // in the kind
  EXPECT_EQ(near("pad.msh"), "../meshes/pad.msh");               // without the folder
  EXPECT_EQ(near("meshes/pad.msh"), "../meshes/pad.msh");        // a step too low
  EXPECT_EQ(near("path.csv"), "data/path.csv");
  EXPECT_EQ(near("own/kidney.vtu"), "own/liver.vtu");  // nothing else is there
}

TEST_F(NearestFile, IsSilentOtherwise) {
  EXPECT_EQ(near("../meshes/kidney.msh"), "");  // two that it could be
  EXPECT_EQ(near("nothing.like"), "");
  EXPECT_EQ(near(""), "");
  EXPECT_EQ(nearest_file("/no/such/folder", "pad.msh"), "");
}

}  // namespace
}  // namespace sutura
