#include "core/constraints/glue.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/constraints/carrier.h"
#include "core/tetmesh/triangle_tree.h"

namespace softreel {
namespace {

Vec3 weighted(const Tet& tet, const std::array<double, 4>& weights, std::span<const Vec3> positions) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 4; ++k) sum += weights[k] * positions[at(tet[k])];
  return sum;
}

/// Young's modulus over the size of an element, as the long edge of a lattice tetrahedron of its volume, N/m^3.
double stiffness_of_area(const GluedMesh& glued, Index element) {
  const TetNodes x = nodes_of(glued.mesh.tets[at(element)], glued.mesh.nodes);
  return glued.materials[at(element)].youngs_modulus / std::cbrt(12 * tet_volume(x[0], x[1], x[2], x[3]));
}

/// The vertices that triangles use, with the nodes at `positions`; the others rest.
std::vector<Vec3> move_surface(const GluedMesh& glued, const std::vector<Triangle>& triangles,
                               std::span<const Vec3> positions) {
  std::vector<Vec3> moved = glued.surface_points;
  std::vector<std::uint8_t> done(moved.size(), 0);
  for (const Triangle& triangle : triangles)
    for (const Index vertex : triangle) {
      if (done[at(vertex)] != 0) continue;
      done[at(vertex)] = 1;
      const Tet& tet = glued.mesh.tets[at(glued.embedding.elements[at(vertex)])];
      const std::array<double, 4>& weights = glued.embedding.weights[at(vertex)];
      moved[at(vertex)] += weighted(tet, weights, positions) - weighted(tet, weights, glued.mesh.nodes);
    }
  return moved;
}

/// Weights of a point of a triangle's plane.
Vec3 triangle_weights(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double square = normal.squaredNorm();
  if (!(square > 0)) return {1, 0, 0};
  Vec3 weights;
  weights[1] = (p - corners[0]).cross(corners[2] - corners[0]).dot(normal) / square;
  weights[2] = (corners[1] - corners[0]).cross(p - corners[0]).dot(normal) / square;
  weights[0] = 1 - weights[1] - weights[2];
  return weights;
}

/// Binds the points of one glue.
class Binder {
 public:
  Binder(const Glue& glue, std::int64_t number, const GluedMesh& glued, std::span<const Vec3> positions, double frame)
      : glue_(glue),
        number_(number),
        glued_(glued),
        positions_(positions),
        frame_(frame),
        moved_(move_surface(glued, glue.triangles, positions)),
        tree_(moved_, glue.triangles) {}

  std::vector<GlueBond> bind() const {
    std::vector<GlueBond> bonds;
    for (std::size_t p = 0; p < glue_.points.size(); ++p) {
      const Vec3 place = place_of(glue_.points[p]);
      const double limit = glue_.distance * (1 + 1e-12);  // a distance said in the digits of the places holds
      const TriangleTree::Nearest nearest =
          tree_.nearest(place, limit * limit, [](Index, const Vec3&) { return true; });
      if (nearest.triangle >= 0) bonds.push_back(bond(static_cast<Index>(p), place, nearest));
    }
    if (bonds.empty()) throw too_far();
    return bonds;
  }

 private:
  Vec3 place_of(const GluePoint& point) const {
    return weighted(glued_.mesh.tets[at(point.element)], point.weights, positions_);
  }

  GlueBond bond(Index point, const Vec3& place, const TriangleTree::Nearest& nearest) const {
    const CarrierMesh rest{glued_.mesh.tets, glued_.node_elements, glued_.mesh.nodes, glued_.mesh.nodes};
    const CarrierMesh now{glued_.mesh.tets, glued_.node_elements, glued_.mesh.nodes, positions_};
    const Triangle& triangle = glue_.triangles[at(nearest.triangle)];
    const Vec3 weights =
        triangle_weights({moved_[at(triangle[0])], moved_[at(triangle[1])], moved_[at(triangle[2])]}, nearest.point);
    Vec3 rest_point = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      rest_point += weights[k] * glued_.surface_points[at(triangle[static_cast<std::size_t>(k)])];
    Eigen::Index corner = 0;
    weights.maxCoeff(&corner);
    const Index start = glued_.embedding.elements[at(triangle[static_cast<std::size_t>(corner)])];
    const Carrier surface = walk_to_carrier(rest, start, glue_.elements.first, glue_.elements.last, rest_point);
    const Carrier carrier = best_carrier_around(now, surface.element, place);
    if (carrier.element < 0) throw crushed(rest_point);
    const Carrier closed = carrier_in(now, carrier.element, nearest.point);
    const GluePoint& own = glue_.points[at(point)];
    const double firmness =
        kFirmness * own.area *
        std::min(stiffness_of_area(glued_, own.element), stiffness_of_area(glued_, carrier.element));
    return {number_, point, carrier.element, frame_, firmness, carrier.weights, closed.weights};
  }

  Error too_far() const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const GluePoint& point : glue_.points)
      nearest = std::min(nearest, tree_.nearest(place_of(point)).squared_distance);
    return input_error(
        fmt::format("{}: at frame {:g}, where it starts, no selected point of body \"{}\" is within distance = {:g} m "
                    "of the surface of body \"{}\": the nearest is {:.4g} m away.\n  Accepted: a distance of at least "
                    "that. Raise it, or move the bodies together before the glue starts.",
                    glue_.name, frame_, glue_.body, glue_.distance, glue_.other, std::sqrt(nearest)));
  }

  Error crushed(const Vec3& place) const {
    return input_error(fmt::format(
        "{}: at frame {:g}, where it starts, the tetrahedra of body \"{}\" near ({:.6g}, {:.6g}, {:.6g}) at rest are "
        "crushed flat, so that they can carry no point.\n  Accepted: a body that is not turned inside out there. Let "
        "the glue start at another frame.",
        glue_.name, frame_, glue_.other, place.x(), place.y(), place.z()));
  }

  const Glue& glue_;
  std::int64_t number_;
  const GluedMesh& glued_;
  std::span<const Vec3> positions_;
  double frame_;
  std::vector<Vec3> moved_;
  TriangleTree tree_;
};

/// How far the gaps are closed, 0 to 1.
double closed_share(const Glue& glue, const GlueBond& bond, double frame) {
  if (glue.close_frames <= 0) return 0;
  return eased(Ease::Smooth, std::clamp((frame - bond.since) / glue.close_frames, 0.0, 1.0));
}

}  // namespace

bool is_sticking(const Glue& glue, double frame) {
  return is_active(glue.active, frame) && (glue.stiffness.keys.empty() || glue.stiffness.at(frame) > 0);
}

std::vector<GlueBond> bind_glue(const Glue& glue, std::int64_t number, const GluedMesh& glued,
                                std::span<const Vec3> positions, double frame) {
  return Binder(glue, number, glued, positions, frame).bind();
}

ActivePull glue_springs(const Glue& glue, std::span<const GlueBond> bonds, const TetMesh& mesh, double frame) {
  ActivePull pull;
  pull.max_force = glue.max_force;
  const bool firm = glue.stiffness.keys.empty();
  double area = 0;
  for (const GlueBond& bond : bonds) area += glue.points[at(bond.point)].area;
  const double stiffness_per_area = firm ? 0.0 : glue.stiffness.at(frame) / area;
  for (const GlueBond& bond : bonds) {
    const GluePoint& point = glue.points[at(bond.point)];
    const double share = closed_share(glue, bond, frame);
    Spring spring;
    spring.count = 8;
    for (std::size_t k = 0; k < 4; ++k) {
      spring.nodes[k] = mesh.tets[at(point.element)][k];
      spring.weights[k] = point.weights[k];
      spring.nodes[4 + k] = mesh.tets[at(bond.element)][k];
      spring.weights[4 + k] = -(bond.weights[k] + share * (bond.closed_weights[k] - bond.weights[k]));
    }
    spring.stiffness = firm ? bond.firmness : stiffness_per_area * point.area;
    pull.stiffness += spring.stiffness;
    pull.springs.push_back(spring);
  }
  return pull;
}

}  // namespace softreel
