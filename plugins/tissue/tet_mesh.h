// <TetMesh file="pad.msh" unit="mm"/>: the rest shape of a tissue.
#pragma once

#include "mesh_check.h"
#include "mesh_data.h"
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

  const MeshData& data() const { return data_; }
  const MeshReport& report() const { return checked_.report; }
  const std::vector<BoundaryFace>& boundary() const { return checked_.boundary; }
  /// The tag of a region given by name or number; nothing, and what there is, if no tet has it.
  std::optional<int> region(const std::string& name_or_tag, std::string& error) const;

 protected:
  /// Checks `data` and keeps it; what is wrong with it is said of `what`.
  void take(MeshData data, const std::string& what, Setup& setup);

 private:
  MeshData data_;
  CheckedMesh checked_;
};

}  // namespace sutura::tissue
