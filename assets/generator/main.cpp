/// make_assets DIRECTORY [NAME...]: writes the meshes, textures and rigs that the presets use, all or those named.
#include <algorithm>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "assets/generator/pictures.h"
#include "assets/generator/ply_write.h"
#include "assets/generator/rig.h"
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

struct Picture {
  std::string name;
  DisplayImage (*make)();
};

void write(const std::vector<std::uint8_t>& bytes, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw work_error(path + " cannot be written. Give a folder that exists and has room.");
  std::cout << path << "\n";
}

int run(const std::vector<std::string>& arguments) {
  const Sculpture all[] = {make_creature(), make_colt(), make_bar(), make_octopus(), make_pudding()};
  const Rig rig = make_puppet();
  const Picture pictures[] = {{"patchwork", make_patchwork}, {"weave_normals", make_weave_normals}};
  std::vector<std::string> known;
  for (const Sculpture& s : all) known.push_back(s.name);
  for (const Picture& p : pictures) known.push_back(p.name);
  known.push_back(rig.name);
  std::string names;
  for (const std::string& name : known) names += " " + name;
  if (arguments.empty()) throw input_error("make_assets: no folder is given. Call make_assets DIRECTORY [NAME...].");
  for (std::size_t i = 1; i < arguments.size(); ++i)
    if (std::find(known.begin(), known.end(), arguments[i]) == known.end())
      throw input_error("make_assets: nothing is called " + arguments[i] + ". There are:" + names + ".");
  const auto is_wanted = [&](const std::string& name) {
    return arguments.size() == 1 || std::find(arguments.begin() + 1, arguments.end(), name) != arguments.end();
  };
  const Threads threads;
  for (const Sculpture& s : all)
    if (is_wanted(s.name)) make(s, arguments[0], threads);
  for (const Picture& p : pictures)
    if (is_wanted(p.name)) write(encode_png(p.make()), arguments[0] + "/" + p.name + ".png");
  if (is_wanted(rig.name)) write(encode_glb(rig), arguments[0] + "/" + rig.name + ".glb");
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
