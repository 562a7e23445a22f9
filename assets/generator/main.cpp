/// make_assets DIRECTORY [NAME...]: writes the meshes that the presets use, all or those named.
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "assets/generator/ply_write.h"
#include "assets/generator/sculpture.h"
#include "assets/generator/surface_nets.h"
#include "core/base/error.h"
#include "core/base/parallel.h"

namespace softreel::sculpt {

namespace {

void make(const Sculpture& sculpture, const std::string& directory, const Threads& threads) {
  constexpr int kRelaxations = 12;
  const SurfaceMesh mesh = mesh_surface(sculpture, kRelaxations, threads);
  const std::string path = directory + "/" + sculpture.name + ".ply";
  write_ply(mesh, path);
  const Bounds box = used_bounds(mesh);
  std::cout << path << ": " << mesh.positions.size() << " vertices, " << mesh.triangles.size() << " triangles, x "
            << box.min.x() << " to " << box.max.x() << ", y " << box.min.y() << " to " << box.max.y() << ", z "
            << box.min.z() << " to " << box.max.z() << " m\n";
}

int run(const std::vector<std::string>& arguments) {
  const Sculpture all[] = {make_creature(), make_colt(), make_bar(), make_octopus(), make_pudding()};
  std::string names;
  for (const Sculpture& s : all) names += " " + s.name;
  if (arguments.empty()) throw input_error("make_assets: no folder is given. Call make_assets DIRECTORY [NAME...].");
  for (std::size_t i = 1; i < arguments.size(); ++i)
    if (std::none_of(std::begin(all), std::end(all), [&](const Sculpture& s) { return s.name == arguments[i]; }))
      throw input_error("make_assets: no sculpture is called " + arguments[i] + ". There are:" + names + ".");
  const Threads threads;
  for (const Sculpture& s : all)
    if (arguments.size() == 1 || std::find(arguments.begin() + 1, arguments.end(), s.name) != arguments.end())
      make(s, arguments[0], threads);
  return 0;
}

}  // namespace

}  // namespace softreel::sculpt

int main(int argc, char** argv) {
  try {
    return softreel::sculpt::run({argv + 1, argv + argc});
  } catch (const softreel::Error& error) {
    std::cerr << error.what() << "\n";
    return static_cast<int>(error.kind());
  } catch (const std::exception& error) {
    std::cerr << "make_assets: " << error.what() << "\n";
    return 1;
  }
}
