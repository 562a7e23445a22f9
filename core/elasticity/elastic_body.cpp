#include "core/elasticity/elastic_body.h"

#include <algorithm>

#include <Eigen/LU>

#include "core/base/check.h"
#include "core/elasticity/element_rotation.h"
#include "core/elasticity/rotation_rivals.h"

namespace softreel {
namespace {

/// Elements and nodes per chunk: some ten microseconds of work each; elements a multiple of the lanes.
constexpr std::int64_t kBodyElementGrain = 1024;
constexpr std::int64_t kBodyNodeGrain = 1024;
static_assert(kBodyElementGrain % kRotationLanes == 0 && kBodyElementGrain % kElementLanes == 0);

/// Eq. (3) on one batch of elements [begin, end), at most kRotationLanes; lanes without an element repeat the last one.
void find_batch(const ElasticBody& body, std::span<const Vec3> positions, std::span<Quaternion> rotations,
                std::size_t begin, std::size_t end) {
  MatrixLanes matrices;
  QuaternionLanes quaternions;
  for (std::size_t lane = 0; lane < kRotationLanes; ++lane) {
    const std::size_t e = std::min(begin + lane, end - 1);
    const Mat3 A = element_moment(nodes_of(body.tets[e], body.rest_positions), nodes_of(body.tets[e], positions));
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) matrices.entries[3 * r + c][lane] = A(r, c);
    const Quaternion& guess = rotations[e];
    quaternions.entries[0][lane] = guess.w();
    quaternions.entries[1][lane] = guess.x();
    quaternions.entries[2][lane] = guess.y();
    quaternions.entries[3][lane] = guess.z();
  }
  find_rotations(matrices, quaternions);
  for (std::size_t e = begin; e < end; ++e) {
    const auto& q = quaternions.entries;
    const std::size_t lane = e - begin;
    rotations[e] = Quaternion(q[0][lane], q[1][lane], q[2][lane], q[3][lane]);
  }
}

std::int64_t find_all_consistent(const ElasticBody& body, std::span<const Vec3> positions,
                                 std::span<Quaternion> rotations, const Threads& threads) {
  constexpr std::int64_t kBatchGrain = kBodyElementGrain / kElementLanes;
  const std::span<const ElementBatch> batches = body.batches;
  return static_cast<std::int64_t>(threads.sum_chunks(
      static_cast<std::int64_t>(batches.size()), kBatchGrain, [&](std::int64_t begin, std::int64_t end) {
        return static_cast<double>(find_consistent_rotations(
            batches, positions, rotations, static_cast<std::size_t>(begin), static_cast<std::size_t>(end)));
      }));
}

std::int64_t count_flat(const ElasticBody& body, std::span<const Vec3> positions, const Threads& threads) {
  return static_cast<std::int64_t>(threads.sum_chunks(
      static_cast<std::int64_t>(body.tets.size()), kBodyElementGrain, [&](std::int64_t begin, std::int64_t end) {
        double flat = 0;
        for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e)
          if (deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions)).determinant() <
              kFlatVolume)
            ++flat;
        return flat;
      }));
}

}  // namespace

NodeElements gather_node_elements(const std::vector<Tet>& tets, Index nodes) {
  CHECK(tets.size() < (std::size_t{1} << 30));
  NodeElements result;
  result.offsets.assign(static_cast<std::size_t>(nodes) + 1, 0);
  for (const Tet& tet : tets)
    for (const Index node : tet) ++result.offsets[static_cast<std::size_t>(node) + 1];
  for (std::size_t i = 1; i < result.offsets.size(); ++i) result.offsets[i] += result.offsets[i - 1];
  result.entries.resize(4 * tets.size());
  std::vector<std::int64_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t e = 0; e < tets.size(); ++e)
    for (std::size_t k = 0; k < 4; ++k)
      result.entries[static_cast<std::size_t>(next[static_cast<std::size_t>(tets[e][k])]++)] =
          static_cast<std::uint32_t>(4 * e + k);
  return result;
}

ElasticBody make_elastic_body(const TetMesh& mesh, const std::vector<ElementMaterial>& materials,
                              Dilatation dilatation) {
  ElasticBody body;
  body.rest_positions = mesh.nodes;
  body.tets = mesh.tets;
  body.shapes.reserve(mesh.tets.size());
  body.laws.reserve(mesh.tets.size());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    body.shapes.push_back(find_element_shape(nodes_of(mesh.tets[e], mesh.nodes)));
    body.shapes.back().volume *= mesh.fill_of(e);  // of its material: what gives stress and energy
    body.laws.push_back({materials[e].lame_lambda(), materials[e].lame_mu(), dilatation == Dilatation::Capped});
  }
  body.batches = make_element_batches(body.tets, body.shapes, body.laws);
  body.node_elements = gather_node_elements(mesh.tets, static_cast<Index>(mesh.nodes.size()));
  body.node_slabs = make_node_slabs(mesh.tets, mesh.nodes.size());
  return body;
}

void find_rotations(const ElasticBody& body, RotationMethod method, std::span<const Vec3> positions,
                    std::span<Quaternion> rotations, const Threads& threads) {
  if (method == RotationMethod::None) {
    std::fill(rotations.begin(), rotations.end(), Quaternion::Identity());
    return;
  }
  if (method == RotationMethod::Consistent) {
    find_all_consistent(body, positions, rotations, threads);
    return;
  }
  if (method != RotationMethod::Energy) {
    find_rival_rotations(body, method, positions, rotations, threads);
    return;
  }
  threads.for_chunks(static_cast<std::int64_t>(body.tets.size()), kBodyElementGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (std::int64_t e = begin; e < end; e += kRotationLanes)
                         find_batch(body, positions, rotations, static_cast<std::size_t>(e),
                                    static_cast<std::size_t>(std::min<std::int64_t>(e + kRotationLanes, end)));
                     });
}

std::int64_t find_rotations_and_flat(const ElasticBody& body, RotationMethod method, std::span<const Vec3> positions,
                                     std::span<Quaternion> rotations, const Threads& threads) {
  if (method == RotationMethod::Consistent) return find_all_consistent(body, positions, rotations, threads);
  find_rotations(body, method, positions, rotations, threads);
  return count_flat(body, positions, threads);
}

void find_stresses(const ElasticBody& body, std::span<const Vec3> positions, std::span<const Quaternion> rotations,
                   std::span<Mat3> stresses, const Threads& threads) {
  threads.for_chunks(
      static_cast<std::int64_t>(body.tets.size()), kBodyElementGrain, [&](std::int64_t begin, std::int64_t end) {
        for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
          const Mat3 F = deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions));
          stresses[e] = body.shapes[e].volume * corotated_stress(body.laws[e], rotations[e].toRotationMatrix(), F);
        }
      });
}

void gather_forces(const ElasticBody& body, std::span<const Mat3> stresses, std::span<Vec3> forces,
                   const Threads& threads) {
  const NodeElements& gather = body.node_elements;
  threads.for_chunks(static_cast<std::int64_t>(forces.size()), kBodyNodeGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                         Vec3 force = Vec3::Zero();
                         for (std::int64_t k = gather.offsets[i]; k < gather.offsets[i + 1]; ++k) {
                           const std::uint32_t entry = gather.entries[static_cast<std::size_t>(k)];
                           const std::size_t e = entry / 4;
                           force -= stresses[e] * body.shapes[e].gradients.col(entry % 4);
                         }
                         forces[i] = force;
                       }
                     });
}

double elastic_energy(const ElasticBody& body, std::span<const Vec3> positions, std::span<const Quaternion> rotations,
                      const Threads& threads) {
  return threads.sum_chunks(
      static_cast<std::int64_t>(body.tets.size()), kBodyElementGrain, [&](std::int64_t begin, std::int64_t end) {
        double sum = 0;
        for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
          const Mat3 F = deformation_gradient(body.shapes[e].gradients, nodes_of(body.tets[e], positions));
          sum += body.shapes[e].volume * corotated_energy(body.laws[e], rotations[e].toRotationMatrix(), F);
        }
        return sum;
      });
}

}  // namespace softreel
