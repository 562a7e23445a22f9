#include "tool/report/cut_plane.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

[[noreturn]] void fail_cut(const std::string& text) {
  throw input_error(fmt::format(
      "--cut {}: this is no plane.\n  Accepted: x, y, z, -x, -y or -z, with a share of the box from 0 to 1 if it is "
      "not 0.5 (x=0.3), or a point and a direction in the mesh's unit (0,1,0:1,0,0). Leave it out for the middle.",
      text));
}

/// Numbers separated by commas; nothing unless all of `text` is that many finite ones.
template <std::size_t N>
std::optional<std::array<double, N>> parse_numbers(std::string_view text) {
  std::array<double, N> values{};
  const char *at = text.data(), *const end = at + text.size();
  for (std::size_t k = 0; k < N; ++k) {
    const auto [stopped, code] = std::from_chars(at, end, values[k]);
    if (code != std::errc{} || !std::isfinite(values[k])) return std::nullopt;
    const bool is_last = k + 1 == N;
    if (is_last ? stopped != end : stopped == end || *stopped != ',') return std::nullopt;
    at = is_last ? end : stopped + 1;
  }
  return values;
}

CutPlane axis_plane(const std::string& text, const Bounds& box, const Vec3& center) {
  std::string_view rest = text;
  const bool negative = rest.starts_with('-');
  if (negative) rest.remove_prefix(1);
  if (rest.empty() || rest[0] < 'x' || rest[0] > 'z') fail_cut(text);
  const int axis = rest[0] - 'x';
  rest.remove_prefix(1);
  CutPlane plane;
  plane.point = center;
  if (!rest.empty()) {
    const auto share = parse_numbers<1>(rest.substr(1));
    if (rest[0] != '=' || !share || !((*share)[0] >= 0 && (*share)[0] <= 1)) fail_cut(text);
    plane.point[axis] = box.min[axis] + (*share)[0] * box.size()[axis];
  }
  plane.normal = (negative ? -1 : 1) * Vec3::Unit(axis);
  return plane;
}

const Vec3& node_of(const TetMesh& mesh, Index node) {
  return mesh.nodes[static_cast<std::size_t>(node)];
}

}  // namespace

CutSpace cut_space(const std::vector<const TetMesh*>& meshes) {
  CutSpace space;
  for (const TetMesh* mesh : meshes)
    for (const Tet& tet : mesh->tets)
      for (const Index node : tet) space.box.add(node_of(*mesh, node));
  const Vec3 origin = space.box.center();  // far from zero, sums of products would lose their digits
  Vec3 moment = Vec3::Zero();
  double volume = 0;
  for (const TetMesh* mesh : meshes)
    for (const Tet& tet : mesh->tets) {
      const Vec3 &a = node_of(*mesh, tet[0]), &b = node_of(*mesh, tet[1]), &c = node_of(*mesh, tet[2]),
                 &d = node_of(*mesh, tet[3]);
      const double share = tet_volume(a, b, c, d);
      moment += 0.25 * share * (a + b + c + d - 4 * origin);
      volume += share;
    }
  space.center = origin + moment / volume;
  return space;
}

CutPlane cut_plane(const std::string& text, const Bounds& box, const Vec3& center) {
  if (text.empty()) return axis_plane(box.size().x() < box.size().z() ? "x" : "z", box, center);
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return axis_plane(text, box, center);
  const auto point = parse_numbers<3>(std::string_view(text).substr(0, colon));
  const auto normal = parse_numbers<3>(std::string_view(text).substr(colon + 1));
  if (!point || !normal || Vec3(normal->data()).isZero(0)) fail_cut(text);
  return {Vec3(point->data()), Vec3(normal->data())};
}

void check_cut(const std::string& text) {
  Bounds unit;
  unit.add(Vec3::Zero());
  unit.add(Vec3::Ones());
  cut_plane(text, unit, unit.center());
}

std::string cut_facing(const Vec3& toward) {
  Eigen::Index axis = 0;
  toward.cwiseAbs().maxCoeff(&axis);
  return std::string(toward[axis] < 0 ? "-" : "") + "xyz"[axis];
}

}  // namespace softreel
