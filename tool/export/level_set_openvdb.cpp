// The one source that includes OpenVDB: see level_set.h.
#include <cstdio>
#include <sstream>

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/ValueTransformer.h>

#include "core/base/error.h"
#include "tool/export/level_set.h"

namespace softreel {
namespace {

/// The surface as OpenVDB's converter asks for it, in double: points in units of voxels, triangles by number.
class VoxelSurface {
 public:
  VoxelSurface(const LevelSetSurface& surface, double voxel) : surface_(surface), voxels_per_unit_(1 / voxel) {}

  std::size_t polygonCount() const { return surface_.triangles.size(); }
  std::size_t pointCount() const { return surface_.positions.size(); }
  std::size_t vertexCount(std::size_t /*polygon*/) const { return 3; }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, openvdb::Vec3d& point) const {
    const Vec3& p = surface_.positions[static_cast<std::size_t>(surface_.triangles[polygon][corner])];
    point = openvdb::Vec3d(p.x(), p.y(), p.z()) * voxels_per_unit_;
  }

 private:
  const LevelSetSurface& surface_;
  double voxels_per_unit_;
};

openvdb::FloatGrid::Ptr make_grid(const LevelSetSurface& surface, const LevelSetParams& params) {
  const auto transform = openvdb::math::Transform::createLinearTransform(params.voxel);
  const auto half_width = static_cast<float>(params.half_width);
  const VoxelSurface voxels(surface, params.voxel);
  if (!surface.is_inside)
    return openvdb::tools::meshToVolume<openvdb::FloatGrid>(voxels, *transform, half_width, half_width);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(voxels, *transform, half_width, half_width,
                                                                     openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  openvdb::tools::foreach (grid->beginValueOn(), [&](const openvdb::FloatGrid::ValueOnIter& value) {
    const openvdb::Vec3d p = transform->indexToWorld(value.getCoord());
    if (surface.is_inside(Vec3(p.x(), p.y(), p.z()))) value.setValue(-*value);
  });
  openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

/// OpenVDB writes files that readers can seek in to a path only; this writes the same bytes to a stream.
class SeekableArchive : public openvdb::io::Archive {
 public:
  void write_to(std::ostream& out, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) const {
    write(out, grids, /*seekable=*/true, metadata);
  }
};

/// The header ends in an identifier of 36 characters that is another one whenever a file is written. It is replaced by
/// one of the content, so that equal frames are equal files.
void name_by_content(std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kBegin = 8 + 3 * 4 + 1, kLength = 36;
  if (bytes.size() < kBegin + kLength || bytes[kBegin + 8] != '-' || bytes[kBegin + 23] != '-')
    throw work_error("OpenVDB wrote a header that softreel does not know. Report this with the library's version.");
  // FNV-1a (Fowler, Noll, Vo), twice with different starts.
  std::uint64_t a = 0xcbf29ce484222325U, b = 0x84222325cbf29ce4U;
  for (std::size_t i = kBegin + kLength; i < bytes.size(); ++i) {
    a = (a ^ bytes[i]) * 0x100000001b3U;
    b = (b ^ bytes[i]) * 0x100000001b3U;
  }
  char text[kLength + 1];
  std::snprintf(text, sizeof text, "%08x-%04x-%04x-%04x-%012llx", static_cast<unsigned>(a >> 32),
                static_cast<unsigned>(a >> 16 & 0xffff), static_cast<unsigned>(a & 0xffff),
                static_cast<unsigned>(b >> 48), static_cast<unsigned long long>(b & 0xffffffffffffU));
  std::copy(text, text + kLength, bytes.begin() + kBegin);
}

std::vector<std::uint8_t> write(const openvdb::FloatGrid::ConstPtr& grid) {
  openvdb::MetaMap metadata;
  metadata.insertMeta("creator", openvdb::StringMetadata("softreel"));
  std::ostringstream out;
  SeekableArchive().write_to(out, {grid}, metadata);
  const std::string text = std::move(out).str();
  std::vector<std::uint8_t> bytes(text.begin(), text.end());
  name_by_content(bytes);
  return bytes;
}

}  // namespace

void softreel_encode_level_set(const LevelSetSurface& surface, const LevelSetParams& params,
                               std::vector<std::uint8_t>& bytes) {
  try {
    openvdb::initialize();
    const openvdb::FloatGrid::Ptr grid = make_grid(surface, params);
    grid->setName(params.grid_name);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    bytes = write(grid);
  } catch (const openvdb::Exception& problem) {
    throw work_error(std::string("OpenVDB could not make the level set: ") + problem.what());
  } catch (const std::bad_alloc&) {
    throw work_error("the level set does not fit into memory.\n  Accepted: a larger --voxel.");
  }
}

}  // namespace softreel
