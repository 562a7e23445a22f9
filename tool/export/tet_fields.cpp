#include "tool/export/tet_fields.h"

#include <algorithm>
#include <array>
#include <map>

#include "core/base/check.h"
#include "core/elasticity/element.h"
#include "core/elasticity/element_rotation.h"
#include "core/elasticity/element_strain.h"

namespace softreel {
namespace {

constexpr std::int64_t kGrain = 512;

/// VTK's order of a symmetric tensor.
void put(const Mat3& tensor, float* six) {
  const std::array<double, 6> values{tensor(0, 0), tensor(1, 1), tensor(2, 2),
                                     tensor(0, 1), tensor(1, 2), tensor(0, 2)};
  std::transform(values.begin(), values.end(), six, [](double x) { return static_cast<float>(x); });
}

/// Fills element e.
void find_fields_of(const DeformedTets& body, std::size_t e, TetFields& fields) {
  const Mat3 F = deformation_gradient(nodes_of(body.tets[e], body.rest), nodes_of(body.tets[e], body.deformed));
  const ElementMaterial& material = body.materials[e];
  const ElasticLaw law{material.lame_lambda(), material.lame_mu(), body.dilatation == Dilatation::Capped};
  const Mat3 rotation = find_rotation(F, Quaternion::Identity()).toRotationMatrix();
  const Mat3 cauchy = cauchy_stress(corotated_stress(law, rotation, F), F);
  const Vec3 stretches = principal_stretches(F);
  fields.strain[e] = static_cast<float>(largest_strain(stretches));
  fields.von_mises_stress[e] = static_cast<float>(von_mises_stress(stretches, material));
  fields.cauchy_von_mises[e] = static_cast<float>(von_mises_of(cauchy));
  put(green_strain(F), &fields.green_strain[6 * e]);
  put(cauchy, &fields.cauchy_stress[6 * e]);
}

}  // namespace

TetFields find_tet_fields(const DeformedTets& body, const Threads& threads) {
  const std::size_t count = body.tets.size();
  CHECK(body.materials.size() == count);
  TetFields fields{std::vector<float>(count), std::vector<float>(count), std::vector<float>(6 * count),
                   std::vector<float>(6 * count), std::vector<float>(count)};
  threads.for_chunks(static_cast<std::int64_t>(count), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t e = begin; e < end; ++e) find_fields_of(body, static_cast<std::size_t>(e), fields);
  });
  return fields;
}

std::vector<Index> number_materials(const std::vector<ElementMaterial>& materials) {
  std::map<std::array<double, 5>, Index> known;
  std::vector<Index> numbers;
  numbers.reserve(materials.size());
  for (const ElementMaterial& m : materials) {
    const std::array<double, 5> values{m.youngs_modulus, m.poisson_ratio, m.density, m.damping_mass,
                                       m.damping_stiffness};
    numbers.push_back(known.try_emplace(values, static_cast<Index>(known.size())).first->second);
  }
  return numbers;
}

}  // namespace softreel
