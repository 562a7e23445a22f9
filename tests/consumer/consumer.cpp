/// Compiles against softreel as another project would.
#include "core/dynamics/simulator.h"
#include "core/mesh/surface_mesh.h"
#include "render/scene/scene.h"

softreel::BodyModel model_of_consumer() {
  return {};
}
