#include "tool/commands/preview_cut.h"

namespace softreel {

PreviewCut::PreviewCut(ShotRun& run, const SceneStage& scenes, const std::string& cut)
    : run_(run), scenes_(scenes), cut_(cut) {
  if (!cut_.empty()) return;
  const Camera camera = scenes.camera(run.shot().settings.first_frame);
  cut_ = cut_facing((camera.position - camera.target).cast<double>());
}

void PreviewCut::replace_bodies(int frame, const std::vector<SkinnedBody>& bodies, Scene& scene) {
  if (!cuts_) {
    std::vector<const TetMesh*> meshes;
    for (std::size_t b = 0; b < bodies.size(); ++b) meshes.push_back(&run_.filled(b)->mesh);
    cuts_.emplace(std::move(meshes), cut_);
  }
  const RenderSettings& render = run_.shot().render;
  scene.meshes.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    std::vector<float> heat;
    if (const HeatQuantity quantity = render.heat.quantity; quantity != HeatQuantity::None) {
      const HeatRange range = scenes_.heat_range();
      for (const double value : run_.element_heat(b, frame, quantity)) heat.push_back(range.place(value));
    }
    cuts_->add_meshes(b, bodies[b].times.back().nodes, heat, render.params.width, scene.meshes);
  }
}

std::vector<std::vector<char>> PreviewCut::shown_points() const {
  std::vector<std::vector<char>> shown;
  for (std::size_t b = 0; b < run_.body_count(); ++b) {
    std::vector<char>& points = shown.emplace_back();
    for (const Index element : run_.filled(b)->embedding.elements) points.push_back(cuts_->keeps(b, element) ? 1 : 0);
  }
  return shown;
}

}  // namespace softreel
