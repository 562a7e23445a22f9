#include "tool/report/cut_picture.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/tetmesh/tet_quality.h"

namespace softreel {
namespace {

const Vec3f kOuter(0.24f, 0.38f, 0.54f), kOuterLine(0.035f, 0.06f, 0.09f), kCutLine(0.10f, 0.06f, 0.03f);
constexpr float kLineWidth = 1.25f;  ///< pixels

/// Colours of the smallest dihedral angles 0, 10, ... 60 degrees, linear; between them they are blended.
const std::array<Vec3f, 7> kAngleColors = {
    Vec3f(0.33f, 0.01f, 0.02f), Vec3f(0.52f, 0.04f, 0.02f), Vec3f(0.66f, 0.13f, 0.03f), Vec3f(0.72f, 0.27f, 0.06f),
    Vec3f(0.74f, 0.40f, 0.11f), Vec3f(0.75f, 0.50f, 0.18f), Vec3f(0.76f, 0.56f, 0.24f)};
constexpr std::size_t kTints = 13;  ///< 0, 5, ... 60 degrees

[[noreturn]] void fail_cut(const std::string& text) {
  throw input_error(fmt::format(
      "--cut {}: this is no plane.\n  Accepted: x, y, z, -x, -y or -z, with a share of the box from 0 to 1 if it is "
      "not "
      "0.5 (x=0.3), or a point and a direction in the mesh's unit (0,1,0:1,0,0). Leave it out for the middle.",
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

Bounds box_of(const TetMesh& mesh) {
  Bounds box;
  for (const Tet& tet : mesh.tets)
    for (const Index node : tet) box.add(mesh.nodes[static_cast<std::size_t>(node)]);
  return box;
}

std::array<Vec3, 4> corners_of(const TetMesh& mesh, Index element) {
  std::array<Vec3, 4> x;
  const Tet& tet = mesh.tets[static_cast<std::size_t>(element)];
  for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[static_cast<std::size_t>(tet[k])];
  return x;
}

/// Of even density.
Vec3 center_of_mass(const TetMesh& mesh) {
  Vec3 moment = Vec3::Zero();
  double volume = 0;
  const Vec3 origin = box_of(mesh).center();  // far from zero, sums of products would lose their digits
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto [a, b, c, d] = corners_of(mesh, static_cast<Index>(e));
    const double share = tet_volume(a, b, c, d);
    moment += 0.25 * share * (a + b + c + d - 4 * origin);
    volume += share;
  }
  return origin + moment / volume;
}

Vec3f tint_color(std::size_t tint) {
  const double place = static_cast<double>(tint) * (kAngleColors.size() - 1) / (kTints - 1);
  const auto low = std::min(static_cast<std::size_t>(place), kAngleColors.size() - 2);
  const auto share = static_cast<float>(place - static_cast<double>(low));
  return (1 - share) * kAngleColors[low] + share * kAngleColors[low + 1];
}

/// The nearest tint to an element's smallest dihedral angle; one without volume has none, and the worst.
std::size_t tint_of(const TetMesh& mesh, Index element) {
  const auto [a, b, c, d] = corners_of(mesh, element);
  const double share = dihedral_range(a, b, c, d).min / (std::numbers::pi / 3);
  if (!(share > 0)) return 0;
  return std::min(static_cast<std::size_t>(std::lround(share * (kTints - 1))), kTints - 1);
}

/// The outer surface first, then the tints from the worst to the best.
std::vector<MotionMesh> cut_meshes(const TetMesh& mesh, const MeshCut& cut) {
  Bounds box;
  for (const CutFace& face : cut.faces)
    for (const Index node : face.nodes) box.add(mesh.nodes[static_cast<std::size_t>(node)]);
  const StudioPlace place(box);
  std::vector<MotionMesh> meshes{studio_mesh("outer", kOuter, kOuterLine, kLineWidth)};
  for (std::size_t k = 0; k < kTints; ++k) meshes.push_back(studio_mesh("cut", tint_color(k), kCutLine, kLineWidth));
  for (const CutFace& face : cut.faces) {
    std::array<Vec3f, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = place(mesh.nodes[static_cast<std::size_t>(face.nodes[k])]);
    add_triangle(meshes[face.outer ? 0 : 1 + tint_of(mesh, face.element)], p[0], p[1], p[2]);
  }
  return meshes;
}

}  // namespace

CutPlane cut_plane(const std::string& text, const Bounds& box, const Vec3& center) {
  if (text.empty()) return axis_plane(box.size().x() < box.size().z() ? "x" : "z", box, center);
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return axis_plane(text, box, center);
  const auto point = parse_numbers<3>(std::string_view(text).substr(0, colon));
  const auto normal = parse_numbers<3>(std::string_view(text).substr(colon + 1));
  if (!point || !normal || Vec3(normal->data()).isZero(0)) fail_cut(text);
  return {Vec3(point->data()), Vec3(normal->data())};
}

void check_cut_picture(const PictureOptions& options) {
  Bounds unit;
  unit.add(Vec3::Zero());
  unit.add(Vec3::Ones());
  cut_plane(options.cut, unit, unit.center());
  check_picture(options);
}

std::string draw_cut_picture(const TetMesh& mesh, const PictureOptions& options, const Threads& threads) {
  const CutPlane plane = cut_plane(options.cut, box_of(mesh), center_of_mass(mesh));
  const MeshCut cut = cut_mesh(mesh, plane);
  if (cut.kept == 0)
    throw input_error(
        fmt::format("--cut {}: no element lies behind the plane.\n  Accepted: a plane that leaves a part "
                    "of the mesh. Move it, or look from the other side.",
                    options.cut));
  draw_in_studio(cut_meshes(mesh, cut), plane.normal, options, threads);
  return fmt::format(
      "{}: {} of {} elements; at the cut tinted by their smallest dihedral angle, from red (0 degrees) to sand (60)",
      options.path, cut.kept, mesh.tets.size());
}

}  // namespace softreel
