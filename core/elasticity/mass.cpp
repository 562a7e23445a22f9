#include "core/elasticity/mass.h"

namespace softreel {

NodalMasses lump_masses(const TetMesh& mesh, const std::vector<ElementMaterial>& materials) {
  NodalMasses masses{std::vector<double>(mesh.nodes.size(), 0.0), std::vector<double>(mesh.nodes.size(), 0.0)};
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const Tet& tet = mesh.tets[e];
    const double volume =
        tet_volume(mesh.nodes[static_cast<std::size_t>(tet[0])], mesh.nodes[static_cast<std::size_t>(tet[1])],
                   mesh.nodes[static_cast<std::size_t>(tet[2])], mesh.nodes[static_cast<std::size_t>(tet[3])]);
    const double share = 0.25 * materials[e].density * mesh.fill_of(e) * volume;
    for (const Index node : tet) {
      masses.mass[static_cast<std::size_t>(node)] += share;
      masses.damping[static_cast<std::size_t>(node)] += share * materials[e].damping_mass;
    }
  }
  return masses;
}

}  // namespace softreel
