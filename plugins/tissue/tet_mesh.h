// <TetMesh file="pad.msh" unit="mm"/>: the rest shape of a tissue.
#pragma once

#include <memory>

#include "rest_shape.h"
#include "sutura/component.h"
#include "sutura/describe.h"

namespace sutura::tissue {

class TetMesh : public Component {
 public:
  static constexpr const char* interface_name = "TetMesh";
  enum class Unit { unstated, m, cm, mm };

  File file;
  Unit unit = Unit::unstated;

  static void describe(Describe<TetMesh>& d);
  void initialise(Setup& setup) override;

  /// Shared by the simulations that have the same mesh. After `initialise`.
  const std::shared_ptr<const RestShape>& shape() const { return shape_; }
  const MeshData& data() const { return shape_->mesh; }
  const MeshReport& report() const { return shape_->checked.report; }
  const std::vector<BoundaryFace>& boundary() const { return shape_->checked.boundary; }
  /// The tag of a region given by name or number; nothing, and what there is, if no tet has it.
  std::optional<int> region(const std::string& name_or_tag, std::string& error) const;

 protected:
  /// Checks `data` and keeps it; what is wrong with it is said of `what`.
  void take(MeshData data, const std::string& what, Setup& setup);

 private:
  std::shared_ptr<const RestShape> shape_ = std::make_shared<RestShape>();
};

}  // namespace sutura::tissue
