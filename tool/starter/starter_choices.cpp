#include "tool/starter/starter_choices.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"
#include "core/mesh/edge_angles.h"
#include "core/mesh/mesh_check.h"
#include "core/tetmesh/quality/tet_quality.h"
#include "tool/starter/starter_selections.h"

namespace softreel {
namespace {

constexpr double kLength = 1.0;        ///< m, of the longest edge of the box: lamps and ground are made for it
constexpr double kStandsFrom = 0.4;    ///< height over width from which a body is taken to stand
constexpr double kFlatUnder = 0.02;    ///< height over width under which there is no height to fit
constexpr double kCreaseDegrees = 40;  ///< between triangles, from which an edge is hard
constexpr double kHover = 0.3;         ///< m above the ground, of bodies that are held at one end
constexpr std::int64_t kTets = 20000, kMoreTets = 80000;
/// Of sheets, in shares of the box's diagonal. Thinner than this hardly shows; where sheets lie closer than that, less.
constexpr double kSheet = 0.02, kThinSheet = 0.005;

/// Share of the box's cross-section that triangles facing down cover at the very bottom along an axis: a base.
double base_share(const SurfaceMesh& mesh, int axis) {
  const Bounds box = used_bounds(mesh);
  const Vec3 size = box.size();
  const double section = size[(axis + 1) % 3] * size[(axis + 2) % 3];
  if (!(section > 0) || !(size[axis] > 0)) return 0;
  const double top = box.min[axis] + 0.01 * size[axis];
  double area = 0;
  for (const Triangle& triangle : mesh.triangles) {
    const auto corner = [&](int k) -> const Vec3& {
      return mesh.positions[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
    };
    if (std::max({corner(0)[axis], corner(1)[axis], corner(2)[axis]}) > top) continue;
    const Vec3 normal = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
    if (normal[axis] < 0) area -= normal[axis];
  }
  return area / section;
}

/// Which axis of the file points up, with the reason.
std::pair<UpAxis, std::string> choose_up(const SurfaceMesh& mesh, const std::string& wish) {
  if (wish == "x") return {UpAxis::X, "As asked."};
  if (wish == "y") return {UpAxis::Y, "As asked."};
  if (wish == "z") return {UpAxis::Z, "As asked."};
  constexpr double kIsBase = 0.1;  // of the section: feet of a printed figure; a round bottom has next to nothing
  const double y = base_share(mesh, 1), z = base_share(mesh, 2);
  if (z > kIsBase && y < 0.25 * z)
    return {UpAxis::Z, "Chosen because the mesh has a flat base below z and none below y."};
  return {UpAxis::Y, "If it lies on its side, try \"z\"."};
}

/// Three digits are enough for a size.
double rounded(double value) {
  return std::stod(fmt::format("{:.3g}", value));
}

void choose_size(const SurfaceMesh& mesh, StarterBody& body) {
  BodySettings& settings = body.settings;
  const Vec3 file_size = used_bounds(mesh).size();
  const int up = settings.up == UpAxis::X ? 0 : settings.up == UpAxis::Y ? 1 : 2;
  const double height = file_size[up], width = std::max(file_size[(up + 1) % 3], file_size[(up + 2) % 3]);
  const double longest = std::max(height, width);
  if (!(longest > 0) || !std::isfinite(longest))
    throw input_error(fmt::format("{}: all its points lie in one place.\n  Accepted: a surface that encloses a volume.",
                                  settings.mesh));
  body.stands = height >= kStandsFrom * width;
  body.slenderness = body.stands ? 1 : longest / std::max(height, kFlatUnder * longest);
  if (height < kFlatUnder * width) {
    settings.scale = rounded(kLength / longest);
    body.size_reason = fmt::format("Makes its longest edge {:.3g} m; in the file it is {:.4g} long.", kLength, longest);
    return;
  }
  settings.fit = rounded(kLength * height / longest);
  body.size_reason = fmt::format("In the file it is {:.4g} high; lamps and camera suit about a metre.", height);
}

/// Area of a horizontal section of a closed surface: what lies above faces up as much more as the section is large.
double section_area(const SurfaceMesh& surface, double height) {
  double area = 0;
  for (const Triangle& triangle : surface.triangles) {
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return surface.positions[static_cast<std::size_t>(triangle[k])];
    };
    const Vec3 &a = corner(0), &b = corner(1), &c = corner(2);
    if ((a + b + c).y() > 3 * height) area += 0.5 * (b - a).cross(c - a).y();
  }
  return area;
}

/// The thinnest section of the lower part over the mean one, at most 1: what the legs are to the body that they carry.
double leg_share(const SurfaceMesh& surface) {
  constexpr int kSections = 20;
  const Bounds box = used_bounds(surface);
  double sum = 0, thinnest = 1e300;
  for (int k = 1; k < kSections; ++k) {
    const double share = static_cast<double>(k) / kSections;
    const double area = section_area(surface, box.min.y() + share * box.size().y());
    sum += area;
    if (share < 0.45) thinnest = std::min(thinnest, area);
  }
  const double mean = sum / (kSections - 1);
  return mean > 0 && thinnest > 0 ? std::min(thinnest / mean, 1.0) : 1.0;  // 1 of what is open
}

/// Places the body over the ground: `fit` stands it there; what is held at one end has room to hang.
void choose_place(const RunContext& context, StarterBody& body) {
  body.loaded = load_body(body.settings, context);
  if (!body.stands || body.settings.fit == 0) {
    const Bounds box = used_bounds(body.loaded.surface);
    const Vec3 foot(box.center().x(), box.min.y(), box.center().z());
    const auto tidy = [](double x) { return std::abs(x) < 1e-9 ? 0.0 : rounded(x); };
    const Vec3 move = Vec3(0, kHover, 0) - foot;
    body.settings.translate = Vec3(tidy(move.x()), tidy(move.y()), tidy(move.z()));
    body.loaded = load_body(body.settings, context);
  }
  body.length = used_bounds(body.loaded.surface).size().maxCoeff();
  body.leg_share = leg_share(body.loaded.surface);
}

/// A way to fill the body, in the order in which they are tried.
struct Filling {
  std::int64_t tets;
  TetMode mode;
  double thickness;  ///< of sheets, share of the box's diagonal; 0: none
  const char* reason;
};

std::vector<Filling> fillings(std::int64_t tets, bool is_open) {
  const std::int64_t usual = tets > 0 ? tets : kTets, more = std::max(usual, kMoreTets);
  std::vector<Filling> ways{
      {usual, TetMode::Conforming, 0, ""},
      {more, TetMode::Conforming, 0, "Fewer are too coarse for its thin parts."},
      {usual, TetMode::Embedded, 0, "Chosen because tetrahedra that end at the surface lose its thin parts."}};
  const char* open = "Chosen because the surface is open and encloses no volume of its own.";
  if (is_open) {
    ways.push_back({usual, TetMode::Embedded, kSheet, open});
    ways.push_back({usual, TetMode::Embedded, kThinSheet, open});
    ways.push_back({more, TetMode::Embedded, kThinSheet, open});
  }
  return ways;
}

/// Fills the body in the first way that works. Throws the error of the first way if none does.
FilledBody fill(const RunContext& context, const StarterWishes& wishes, StarterBody& body) {
  if (body.loaded.given) return fill_body_anew(body.settings, body.loaded, context);
  const bool is_open = check_mesh(body.loaded.file_mesh).boundary_edges > 0;
  std::optional<Error> first;
  for (const Filling& way : fillings(wishes.tets, is_open)) {
    body.settings.tets = way.tets;
    body.settings.mode = way.mode;
    body.settings.thickness = rounded(way.thickness * used_bounds(body.loaded.surface).diagonal());
    body.fill_reason = way.reason;
    try {
      return fill_body_anew(body.settings, body.loaded, context);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::Input) throw;
      if (!first) first = error;
    }
  }
  throw input_error(fmt::format("{}: {}", body.settings.mesh, first->what()));
}

/// Parts of the tetrahedra that are not held firmly, by points that span an area: with weight they would fall out of
/// the picture, or turn about the points that hold them.
void count_loose_pieces(const FilledBody& filled, StarterBody& body) {
  const std::vector<Index> pieces = face_connected_pieces(filled.mesh);
  std::map<Index, std::vector<Index>> held;
  for (const Index piece : pieces) held.try_emplace(piece);
  for (const Index point : select_points(body.held.select, body.loaded.surface))
    held[pieces[static_cast<std::size_t>(filled.embedding.elements[static_cast<std::size_t>(point)])]].push_back(point);
  body.pieces = static_cast<int>(held.size());
  body.loose_pieces = static_cast<int>(std::count_if(held.begin(), held.end(), [&body](const auto& piece) {
    return !spans_an_area(piece.second, body.loaded.surface);
  }));
}

/// Whether a surface is made of flat or smooth parts with hard edges between them. Scans have edges of every angle, and
/// what is to look round but has few triangles has more that are nearly sharp.
bool has_hard_edges(const SurfaceMesh& surface) {
  constexpr double kRadians = std::numbers::pi / 180;
  constexpr double kBentDegrees = 25;   // of mantles of 15 sides and more edges are less
  constexpr double kLeastShare = 0.05;  // of all edges, by length
  constexpr double kMostBent = 0.25;    // over the sharp ones
  const EdgeLengths lengths = measure_edges(surface, kBentDegrees * kRadians, kCreaseDegrees * kRadians);
  return lengths.sharp >= kLeastShare * lengths.all && lengths.sharp > 0 && lengths.bent <= kMostBent * lengths.sharp;
}

}  // namespace

StarterBody choose_body(const std::string& mesh, const std::string& name, const StarterWishes& wishes,
                        const RunContext& context) {
  StarterBody body;
  body.settings.name = name;
  body.settings.mesh = mesh;
  body.settings.mesh_origin.file = body.settings.origin.file = "new";
  const LoadedBody as_file = load_body(body.settings, context);
  std::tie(body.settings.up, body.up_reason) = choose_up(as_file.file_mesh, wishes.up);
  choose_size(as_file.file_mesh, body);
  choose_place(context, body);
  choose_selections(body.loaded.surface, wishes, body);
  const FilledBody filled = fill(context, wishes, body);
  body.tets = filled.mesh.tets.size();
  body.volume = measure_quality(filled.mesh, context.threads).volume;
  count_loose_pieces(filled, body);
  if (has_hard_edges(body.loaded.surface)) body.settings.crease_deg = kCreaseDegrees;
  return body;
}

}  // namespace softreel
