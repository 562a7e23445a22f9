#include "tool/bodies/weight_maps.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/srgb.h"
#include "core/mesh/readers/mesh_source.h"
#include "core/mesh/readers/weight_reader.h"
#include "tool/bodies/at_field.h"

namespace softreel {
namespace {

/// The colour as it was painted: PLY and OBJ hold what a screen shows, which import_mesh makes linear; glTF is linear.
std::vector<double> color_weights(const BodySettings& body, const SurfaceMesh& mesh, const std::string& channel) {
  if (mesh.colors.empty())
    throw input_error(
        fmt::format("{} has no vertex colours.\n  Accepted: a mesh file with colours (PLY, OBJ, glTF). "
                    "Paint the mesh, or give the weights as a file.",
                    body.mesh));
  const Eigen::Index c = channel == "red" ? 0 : channel == "green" ? 1 : 2;
  const bool linear = detail::has_linear_colors(body.mesh);
  std::vector<double> weights;
  for (const Vec3f& color : mesh.colors)
    weights.push_back(double{linear ? std::clamp(color[c], 0.0f, 1.0f) : srgb_encode(color[c])});
  return weights;
}

std::vector<double> attribute_weights(const BodySettings& body, const WeightSource& source) {
  if (!source.file.empty()) return read_weights(source.file, source.attribute);
  if (detail::lower_extension(body.mesh) != ".ply")
    throw input_error(
        fmt::format("{} is no PLY file, and others have no attributes.\n  Accepted: attribute of a PLY "
                    "mesh, or with file = \"X.ply\". Give the weights as a file.",
                    body.mesh));
  return read_weights(body.mesh, source.attribute);
}

WeightMap read_map(const BodySettings& body, const SurfaceMesh& mesh, const WeightSource& source) {
  WeightMap map{source,
                source.color.empty() ? attribute_weights(body, source) : color_weights(body, mesh, source.color)};
  if (map.weights.size() != mesh.positions.size())
    throw input_error(fmt::format(
        "{} has {} weights, but {} has {} vertices.\n  Accepted: a weight for each vertex, in the order of "
        "the mesh file. Export the weights of this mesh.",
        source.file.empty() ? body.mesh : source.file, map.weights.size(), body.mesh, mesh.positions.size()));
  return map;
}

/// Calls visit(source, origin, field) for all weights of a selection.
template <typename Select, typename Visit>
void visit_terms(Select& selection, const Origin& origin, const std::string& field, const Visit& visit) {
  for (auto& term : selection.terms)
    if (auto* painted = std::get_if<SelectWeights>(&term.shape))
      visit(painted->source, origin, field + ".select.weights");
}

/// Calls visit(source, origin, field) for all weights that the body names.
template <typename Body, typename Visit>
void visit_weights(Body& body, const Visit& visit) {
  const auto in_selection = [&](auto& selection, const Origin& origin, const std::string& field) {
    visit_terms(selection, origin, field, visit);
  };
  const auto field = [&](const char* list, std::size_t i) { return fmt::format("body.{}.{}[{}]", body.name, list, i); };
  for (std::size_t i = 0; i < body.regions.size(); ++i)
    in_selection(body.regions[i].select, body.regions[i].origin, field("region", i));
  for (std::size_t i = 0; i < body.pins.size(); ++i)
    in_selection(body.pins[i].select, body.pins[i].origin, field("pin", i));
  for (std::size_t i = 0; i < body.pulls.size(); ++i) {
    in_selection(body.pulls[i].select, body.pulls[i].origin, field("pull", i));
    if (body.pulls[i].weights) visit(*body.pulls[i].weights, body.pulls[i].origin, field("pull", i) + ".weights");
  }
}

}  // namespace

std::vector<WeightMap> read_weight_maps(const BodySettings& body, std::span<const GlueSettings> glues,
                                        const SurfaceMesh& file_mesh) {
  std::vector<WeightMap> maps;
  const auto read = [&](const WeightSource& source, const Origin& origin, const std::string& field) {
    const auto same = [&](const WeightMap& map) { return map.source == source; };
    if (std::none_of(maps.begin(), maps.end(), same))
      maps.push_back(at_field(origin, field, [&] { return read_map(body, file_mesh, source); }));
  };
  visit_weights(body, read);
  for (std::size_t g = 0; g < glues.size(); ++g)
    if (glues[g].bodies.front() == body.name)
      visit_terms(glues[g].select, glues[g].origin, fmt::format("glue[{}]", g), read);
  return maps;
}

std::vector<std::string*> constraint_files(BodySettings& body, std::span<GlueSettings> glues) {
  std::vector<std::string*> files;
  const auto keep = [&](WeightSource& source, const Origin&, const std::string&) {
    if (!source.file.empty()) files.push_back(&source.file);
  };
  visit_weights(body, keep);
  for (GlueSettings& glue : glues)
    if (glue.bodies.front() == body.name) visit_terms(glue.select, glue.origin, "", keep);
  for (PinSettings& pin : body.pins)
    if (pin.follow) files.push_back(&pin.follow->file);
  for (PullSettings& pull : body.pulls)
    if (pull.follow) files.push_back(&pull.follow->file);
  return files;
}

}  // namespace softreel
