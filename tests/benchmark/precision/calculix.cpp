#include "tests/benchmark/precision/calculix.h"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace softreel::bench {
namespace {

/// Edges of a tetrahedron in the order of C3D10's nodes 5 to 10.
constexpr std::array<std::array<std::size_t, 2>, 6> kEdges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// A folder that goes when it is no longer needed.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "softreel_ccx_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder for ccx can be made");
    path_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;  // what stays behind in a temporary folder harms nobody
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Runs `ccx argument` in a folder on one thread, its output in ccx.log. True if it ended with status 0.
bool start_calculix(const std::string& argument, const std::filesystem::path& folder) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("ccx: no process can be started");
  if (child == 0) {
    const int log = open((folder / "ccx.log").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (log < 0 || chdir(folder.c_str()) != 0) _exit(126);
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    setenv("OMP_NUM_THREADS", "1", 1);
    execlp("ccx", "ccx", argument.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("ccx: its end was not seen");
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

double children_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Nodes and elements; ccx numbers both from 1 and reads numbers of at most 20 characters.
struct CalculixMesh {
  std::vector<Vec3> nodes;
  std::vector<std::vector<std::size_t>> elements;
};

CalculixMesh mesh_for(const TetMesh& mesh, CalculixElement element) {
  CalculixMesh result{mesh.nodes, {}};
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
  for (const Tet& tet : mesh.tets) {
    std::vector<std::size_t> nodes(tet.begin(), tet.end());
    if (element == CalculixElement::Quadratic)
      for (const auto& [a, b] : kEdges) {
        const auto edge = std::minmax(nodes[a], nodes[b]);
        const auto [at, added] = middles.emplace(edge, result.nodes.size());
        if (added) result.nodes.emplace_back(0.5 * (result.nodes[edge.first] + result.nodes[edge.second]));
        nodes.push_back(at->second);
      }
    result.elements.push_back(std::move(nodes));
  }
  return result;
}

void write_input(const Bar& bar, CalculixElement element, const std::vector<Index>& watched, const Vec3& load,
                 CalculixStatics statics, const std::filesystem::path& path) {
  const CalculixMesh mesh = mesh_for(bar.model.mesh, element);
  std::string text = "*NODE, NSET=NALL\n";
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    text +=
        fmt::format("{}, {:.12g}, {:.12g}, {:.12g}\n", i + 1, mesh.nodes[i].x(), mesh.nodes[i].y(), mesh.nodes[i].z());
  text += fmt::format("*ELEMENT, TYPE={}, ELSET=EALL\n", element == CalculixElement::Linear ? "C3D4" : "C3D10");
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    text += fmt::format("{}", e + 1);
    for (const std::size_t node : mesh.elements[e]) text += fmt::format(", {}", node + 1);
    text += '\n';
  }
  const ElementMaterial& material = bar.model.materials.front();
  text += fmt::format("*MATERIAL, NAME=M\n*ELASTIC\n{:.12g}, {:.12g}\n*DENSITY\n{:.12g}\n", material.youngs_modulus,
                      material.poisson_ratio, material.density);
  text += "*SOLID SECTION, ELSET=EALL, MATERIAL=M\n*BOUNDARY\n";
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (mesh.nodes[i].x() < 1e-9 * bar.length) text += fmt::format("{}, 1, 3\n", i + 1);
  text += "*NSET, NSET=WATCHED\n";
  for (const Index node : watched) text += fmt::format("{},\n", node + 1);
  text += calculix_step(statics);
  if (const double g = bar.model.gravity.norm(); g > 0)
    text += fmt::format("*DLOAD\nEALL, GRAV, {:.12g}, {:.12g}, {:.12g}, {:.12g}\n", g, bar.model.gravity.x() / g,
                        bar.model.gravity.y() / g, bar.model.gravity.z() / g);
  if (load.norm() > 0) {
    text += "*CLOAD\n";
    for (const Index node : watched)
      for (int c = 0; c < 3; ++c)
        if (load[c] != 0)
          text += fmt::format("{}, {}, {:.12g}\n", node + 1, c + 1, load[c] / static_cast<double>(watched.size()));
  }
  text += "*NODE PRINT, NSET=WATCHED, FREQUENCY=1000\nU\n*END STEP\n";
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

/// The last displacement that the file has of each watched node.
std::vector<Vec3> read_displacements(const std::filesystem::path& path, const std::vector<Index>& watched) {
  std::map<long, Vec3> found;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    long node = 0;
    Vec3 u = Vec3::Zero();
    if (words >> node >> u.x() >> u.y() >> u.z()) found[node] = u;
  }
  std::vector<Vec3> result;
  for (const Index node : watched) {
    const auto at = found.find(node + 1);
    if (at == found.end()) throw std::runtime_error(fmt::format("ccx printed nothing of node {}", node + 1));
    result.push_back(at->second);
  }
  return result;
}

std::string end_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return text.size() <= 300 ? text : text.substr(text.size() - 300);
}

}  // namespace

std::string calculix_step(CalculixStatics statics) {
  return statics == CalculixStatics::Linear ? "*STEP\n*STATIC\n1., 1.\n" : "*STEP, NLGEOM, INC=1000\n*STATIC\n1., 1.\n";
}

bool has_calculix() {
  static const bool found = [] {
    const Scratch scratch;
    start_calculix("-v", scratch.path());
    return end_of(scratch.path() / "ccx.log").find("ersion") != std::string::npos;
  }();
  return found;
}

CalculixAnswer solve_by_calculix(const Bar& bar, CalculixElement element, const std::vector<Index>& watched,
                                 const Vec3& load, CalculixStatics statics) {
  const Scratch scratch;
  write_input(bar, element, watched, load, statics, scratch.path() / "bar.inp");
  const double start = children_seconds();
  const bool ended = start_calculix("bar", scratch.path());
  CalculixAnswer answer;
  answer.seconds = children_seconds() - start;
  const std::string log = end_of(scratch.path() / "ccx.log");
  if (!ended || log.find("Job finished") == std::string::npos)
    throw std::runtime_error(fmt::format("ccx found no equilibrium: {}", log));
  answer.displacements = read_displacements(scratch.path() / "bar.dat", watched);
  return answer;
}

}  // namespace softreel::bench
