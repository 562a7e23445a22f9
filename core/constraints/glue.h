/// Glue between the surfaces of two bodies that one simulator moves together.
///
/// Points of the first body's surface are bound to the material of the second: where a bond starts, its point lies at
/// some place, and the nearest tetrahedra of the second body carry that place from then on (barycentric weights, which
/// extrapolate across a gap). A bond is a spring of no length between the two. So nothing jumps where it starts; a gap
/// turns and bends with the body that carries it; and as the force lies along the stretch between the two ends, equal
/// and opposite, it changes neither the linear nor the angular momentum of the two bodies together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/constraints/keys.h"
#include "core/constraints/pulls.h"
#include "core/elasticity/elastic_body.h"
#include "core/elasticity/material.h"
#include "core/skinning/embedding.h"
#include "core/tetmesh/tet_mesh.h"

namespace softreel {

/// A point of a surface with the part of the surface that it stands for.
struct GluePoint {
  Index element = 0;  ///< that carries it
  std::array<double, 4> weights{};
  double area = 0;  ///< m^2, at rest
};

/// The elements of one body in a mesh that holds several: [first, last).
struct ElementRange {
  Index first = 0, last = 0;
};

struct Glue {
  std::string name;                 ///< as messages call it: "glue[0] (shots/a.toml:31)"
  std::string body, other;          ///< names of the bodies
  std::vector<GluePoint> points;    ///< of the first body's surface
  std::vector<Triangle> triangles;  ///< the second body's surface, by surface points of the model
  ElementRange elements;            ///< of the second body
  double distance = 0;              ///< m: points that are no farther from the second surface when the glue starts
  Track<double> stiffness;          ///< N/m, of all bonds together; without keys: firm, see below
  double max_force = 0;             ///< N, of all bonds together, limited as a pull's; 0: no limit
  double close_frames = 0;          ///< in so many frames the gaps close; 0: they stay
  std::vector<FrameRange> active;   ///< empty: always
};

/// Firm glue is as stiff as a layer of the softer body, a hundredth of its tetrahedra thick: it gives way by a
/// hundredth of what the tetrahedra beside it do. Ten times stiffer glue costs more iterations and shows no more.
inline constexpr double kFirmness = 100;

/// A point that is bound. Bonds belong to the simulated state: they are made of the shapes that the bodies have when
/// the glue starts.
struct GlueBond {
  std::int64_t glue = 0;                   ///< which one of the model
  Index point = 0;                         ///< of the glue
  Index element = 0;                       ///< of the second body
  double since = 0;                        ///< frame
  double firmness = 0;                     ///< N/m, if the glue is firm
  std::array<double, 4> weights{};         ///< of the place in the element where the point was
  std::array<double, 4> closed_weights{};  ///< of the nearest place of the second surface
  bool operator==(const GlueBond&) const = default;
};

/// All that glue sees of the bodies; kept by reference.
struct GluedMesh {
  const TetMesh& mesh;
  const NodeElements& node_elements;
  const std::vector<ElementMaterial>& materials;
  const std::vector<Vec3>& surface_points;
  const Embedding& embedding;
};

/// True if glue holds at a frame: it is active and has stiffness.
bool is_sticking(const Glue& glue, double frame);

/// Bonds of a glue (`number` of the model) that starts at `frame` with the nodes at `positions`, ascending by points.
/// Throws input_error if no point is near enough, saying how far the nearest one is, and where the elements that should
/// carry a point are crushed.
std::vector<GlueBond> bind_glue(const Glue& glue, std::int64_t number, const GluedMesh& glued,
                                std::span<const Vec3> positions, double frame);

/// The springs of a glue's bonds at a frame: forces, energy and stiffness are those of pulls. bonds: of this glue.
ActivePull glue_springs(const Glue& glue, std::span<const GlueBond> bonds, const TetMesh& mesh, double frame);

/// Points that stand for the parts of a surface that a selection takes, about `spacing` apart (m), so that glue holds
/// evenly however the surface is divided. A vertex takes the third of each of its triangles that is next to it.
/// embedding: of the surface in `mesh`. Throws input_error for a surface far too large for such a spacing.
std::vector<GluePoint> make_glue_points(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                        const std::vector<Index>& selected, const TetMesh& mesh,
                                        const Embedding& embedding, double spacing);

}  // namespace softreel
