/// VTK unstructured grids of tetrahedra (.vtu): XML with raw binary appended, and arrays of numbers on nodes and cells.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/types.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// Numbers on nodes or elements, as VTK keeps them: `components` in a row for each.
struct VtuArray {
  std::string name;
  const char* type = "Float64";  ///< VTK's name of the number type
  int components = 1;            ///< 1; 3: a vector; 6: a symmetric tensor XX YY ZZ XY YZ XZ
  std::vector<std::uint8_t> bytes;
};

/// Array of Float64, Float32 or Int32 with the values given, which are copied.
template <typename T>
VtuArray vtu_array(std::string name, int components, const std::vector<T>& values) {
  static_assert(std::is_same_v<T, double> || std::is_same_v<T, float> || std::is_same_v<T, Index>);
  const char* type = std::is_same_v<T, double> ? "Float64" : std::is_same_v<T, float> ? "Float32" : "Int32";
  VtuArray array{std::move(name), type, components, std::vector<std::uint8_t>(values.size() * sizeof(T))};
  if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

/// The bytes of a .vtu file. points: m, one per node; tets: by node; arrays: one entry per point or per element.
/// The first scalars of the elements, and the first vectors of the points, are what a viewer shows when it opens it.
std::vector<std::uint8_t> encode_vtu(const std::vector<Vec3>& points, const std::vector<Tet>& tets,
                                     const std::vector<VtuArray>& point_arrays,
                                     const std::vector<VtuArray>& cell_arrays);

}  // namespace softreel
