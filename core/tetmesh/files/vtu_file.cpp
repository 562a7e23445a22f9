#include "core/tetmesh/files/vtu_file.h"

#include <bit>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "core/base/check.h"

namespace softreel {
namespace {

static_assert(std::endian::native == std::endian::little, "the .vtu header says LittleEndian");

/// VTK's number of the linear tetrahedron.
constexpr std::uint8_t kVtkTetra = 10;

/// XML first, then the blocks of bytes that it points to, each behind its size.
class VtuEncoder {
 public:
  template <typename... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(bytes_), format, std::forward<Args>(args)...);
  }

  /// The element of a block that will be appended: of `name` where it has one.
  void declare(const std::string& name, const char* type, int components, std::span<const std::uint8_t> block) {
    print("<DataArray type=\"{}\"", type);
    if (!name.empty()) print(" Name=\"{}\"", name);
    if (components > 1) print(" NumberOfComponents=\"{}\"", components);
    constexpr const char* kTensorNames[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    for (int k = 0; components == 6 && k < 6; ++k) print(" ComponentName{}=\"{}\"", k, kTensorNames[k]);
    print(" format=\"appended\" offset=\"{}\"/>\n", offset_);
    offset_ += sizeof(std::uint64_t) + block.size();
    blocks_.push_back(block);
  }

  void declare_all(const char* where, const std::vector<VtuArray>& arrays) {
    if (arrays.empty()) return;
    print("<{}", where);
    for (const auto& [kind, components] : {std::pair{"Scalars", 1}, std::pair{"Vectors", 3}})
      for (const VtuArray& array : arrays)
        if (array.components == components) {
          print(" {}=\"{}\"", kind, array.name);
          break;
        }
    print(">\n");
    for (const VtuArray& array : arrays) declare(array.name, array.type, array.components, array.bytes);
    print("</{}>\n", where);
  }

  std::vector<std::uint8_t> finish() {
    print("<AppendedData encoding=\"raw\">\n_");
    bytes_.reserve(bytes_.size() + offset_ + 64);
    for (const std::span<const std::uint8_t> block : blocks_) {
      const std::uint64_t size = block.size();
      const auto* const raw = reinterpret_cast<const std::uint8_t*>(&size);
      bytes_.insert(bytes_.end(), raw, raw + sizeof size);
      bytes_.insert(bytes_.end(), block.begin(), block.end());
    }
    print("\n</AppendedData>\n</VTKFile>\n");
    return std::move(bytes_);
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::vector<std::span<const std::uint8_t>> blocks_;
  std::uint64_t offset_ = 0;
};

template <typename T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

std::vector<std::uint8_t> encode_vtu(const std::vector<Vec3>& points, const std::vector<Tet>& tets,
                                     const std::vector<VtuArray>& point_arrays,
                                     const std::vector<VtuArray>& cell_arrays) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Tet) == 4 * sizeof(Index),
                "written as they lie in memory");
  std::vector<std::int64_t> ends(tets.size());
  for (std::size_t e = 0; e < tets.size(); ++e) ends[e] = static_cast<std::int64_t>(4 * (e + 1));
  const std::vector<std::uint8_t> types(tets.size(), kVtkTetra);
  VtuEncoder encoder;
  encoder.print(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
      points.size(), tets.size());
  encoder.declare("", "Float64", 3, bytes_of(points));
  encoder.print("</Points>\n<Cells>\n");
  encoder.declare("connectivity", "Int32", 1, bytes_of(tets));
  encoder.declare("offsets", "Int64", 1, bytes_of(ends));
  encoder.declare("types", "UInt8", 1, types);
  encoder.print("</Cells>\n");
  encoder.declare_all("PointData", point_arrays);
  encoder.declare_all("CellData", cell_arrays);
  encoder.print("</Piece>\n</UnstructuredGrid>\n");
  return encoder.finish();
}

}  // namespace softreel
