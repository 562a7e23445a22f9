#include "core/tetmesh/improvement/angle_improvement.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/tetmesh/improvement/boundary_slide.h"
#include "core/tetmesh/improvement/flips.h"
#include "core/tetmesh/improvement/node_smoothing.h"
#include "core/tetmesh/improvement/tet_stars.h"

namespace softreel {
namespace {

/// At the target or better.
constexpr double kWanted = 1;

/// After so many elements an empty loop looks whether the user wants to stop; one takes less than some milliseconds.
constexpr std::size_t kStopStride = 64;

AngleMeasure make_measure(const TetMesh& mesh, const AngleImprovementParams& params) {
  AngleMeasure measure(params.min_dihedral, params.max_dihedral);
  for (const Tet& tet : mesh.tets) {
    TetCorners x;
    for (std::size_t k = 0; k < 4; ++k) x[k] = mesh.nodes[static_cast<std::size_t>(tet[k])];
    measure.admit(dihedral_cosines(x));
  }
  return measure;
}

class Improver {
 public:
  Improver(TetMesh& mesh, const std::vector<Triangle>& boundary, BoundarySlide* slide,
           const AngleImprovementParams& params)
      : measure_(make_measure(mesh, params)),
        tets_(mesh, measure_),
        on_boundary_(find_boundary_nodes(mesh.nodes.size(), boundary)),
        smoothing_(tets_, slide, on_boundary_),
        flips_(tets_),
        was_moved_(mesh.nodes.size(), false) {}

  AngleImprovement run(int passes, const Threads& threads) {
    for (int pass = 0; pass < passes; ++pass) {
      const std::int64_t before = tets_.now();
      const std::vector<Index> elements = waiting();
      for (std::size_t i = 0; i < elements.size(); ++i) {
        if (i % kStopStride == 0) threads.for_chunks(1, 1, [](std::int64_t, std::int64_t) {});
        improve(elements[i]);
      }
      if (tets_.now() == before) break;
    }
    tets_.compact();
    for (std::size_t i = 0; i < was_moved_.size(); ++i)
      if (was_moved_[i]) ++(on_boundary_[i] ? done_.slid_nodes : done_.moved_nodes);
    return done_;
  }

 private:
  static std::vector<bool> find_boundary_nodes(std::size_t nodes, const std::vector<Triangle>& boundary) {
    std::vector<bool> on_boundary(nodes, false);
    for (const Triangle& face : boundary)
      for (const Index node : face) on_boundary[static_cast<std::size_t>(node)] = true;
    return on_boundary;
  }

  bool is_bad(Index element) const { return !tets_.is_gap(element) && tets_.quality(element) < kWanted; }

  /// Bad elements round which something has changed since they were tried in vain, worst first.
  std::vector<Index> waiting() {
    tried_.resize(tets_.slots(), -1);
    std::vector<Index> elements;
    for (Index e = 0; e < static_cast<Index>(tets_.slots()); ++e)
      if (is_bad(e) && has_changed(e)) elements.push_back(e);
    std::ranges::stable_sort(elements, {}, [&](Index e) { return tets_.quality(e); });
    return elements;
  }

  bool has_changed(Index element) const {
    return std::ranges::any_of(tets_.tet(element), [&](Index node) {
      return tets_.last_change(node) > tried_[static_cast<std::size_t>(element)];
    });
  }

  void improve(Index element) {
    if (!is_bad(element)) return;
    const std::int64_t before = tets_.now();
    if (!flip(element)) smooth(element);
    if (tets_.now() == before) tried_[static_cast<std::size_t>(element)] = before;
  }

  void smooth(Index element) {
    const Tet nodes = tets_.tet(element);
    for (const Index node : nodes)
      if (is_bad(element) && smoothing_.improve(node)) was_moved_[static_cast<std::size_t>(node)] = true;
  }

  bool flip(Index element) {
    if (remove_edge_of(element)) {
      ++done_.removed_edges;
      return true;
    }
    if (remove_face_of(element)) {
      ++done_.removed_faces;
      return true;
    }
    return false;
  }

  bool remove_edge_of(Index element) {
    const Tet nodes = tets_.tet(element);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (flips_.remove_edge(nodes[i], nodes[j])) return true;
    return false;
  }

  bool remove_face_of(Index element) {
    const Tet nodes = tets_.tet(element);
    return std::ranges::any_of(nodes, [&](Index apex) { return flips_.remove_face(element, apex); });
  }

  AngleMeasure measure_;
  TetStars tets_;
  std::vector<bool> on_boundary_;
  NodeSmoothing smoothing_;
  Flips flips_;
  std::vector<std::int64_t> tried_;  ///< per element the number of the last change when it was last tried
  std::vector<bool> was_moved_;      ///< per node
  AngleImprovement done_;
};

std::string describe(const TetQuality& quality) {
  return fmt::format("{:.2f} to {:.2f} degrees (first percentile {:.2f})", quality.min_dihedral, quality.max_dihedral,
                     quality.first_percentile_dihedral);
}

}  // namespace

AngleImprovement improve_angles(TetMesh& mesh, const SurfaceMesh* surface, const AngleImprovementParams& params,
                                const Threads& threads) {
  if (!mesh.fill.empty())
    throw input_error(
        "the tetrahedra are partly filled cells of an embedded body, which cannot be moved or flipped. Accepted: "
        "tetrahedra that end at their surface. Leave the optimisation out.");
  const TetQuality before = measure_quality(mesh, threads);
  std::vector<Triangle> boundary = boundary_faces(mesh);
  std::unique_ptr<BoundarySlide> slide;
  if (surface != nullptr && !surface->triangles.empty() && !boundary.empty())
    slide = std::make_unique<BoundarySlide>(mesh.nodes, boundary, *surface, threads);
  AngleImprovement done = Improver(mesh, boundary, slide.get(), params).run(params.passes, threads);
  done.before = before;
  done.after = measure_quality(mesh, threads);
  return done;
}

std::string describe(const AngleImprovement& improvement) {
  return fmt::format(
      "dihedral angles {} became {}; {} nodes moved inside, {} along the surface, {} edges and {} faces flipped",
      describe(improvement.before), describe(improvement.after), improvement.moved_nodes, improvement.slid_nodes,
      improvement.removed_edges, improvement.removed_faces);
}

}  // namespace softreel
