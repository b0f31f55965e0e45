// In which ways attachments leave a tissue free to move as a rigid body.
#include "free_motion.h"

#include <gtest/gtest.h>

#include "tissue_scene.h"

namespace sutura::test {
namespace {

std::string with(const std::string& attach) {
  TissueScene s(
      "<TetMesh file='tests/unit/tissue/meshes/msh22_ascii.msh' unit='cm'/>"
      "<Tissue poisson='0.3'/>" +
      attach);
  EXPECT_TRUE(s.diagnostics.ok()) << all_messages(s.diagnostics);
  return free_motion(s.tissue().model());
}

TEST(FreeMotion, IsWhatNoAttachmentKeepsItFrom) {
  const std::string all = "box='-9 -9 -9 9 9 9 cm'";
  EXPECT_EQ(with("<Attach " + all + "/>"), "");
  EXPECT_EQ(with("").find("it is free to move in every direction"), 0u) << with("");
  EXPECT_EQ(with("<Attach " + all + " directions='xz'/>").find("it is free to move along y"), 0u);
  EXPECT_EQ(with("<Attach nodes='0'/>").find("it is free to move by turning"), 0u);
  EXPECT_EQ(with("<Attach nodes='0 1'/>").find("it is free to move by turning"), 0u);
  // What slides in three planes is held.
  EXPECT_EQ(with("<Attach name='a' " + all + " directions='x'/><Attach name='b' " + all +
                 " directions='y'/><Attach name='c' " + all + " directions='z'/>"),
            "");
}

}  // namespace
}  // namespace sutura::test
