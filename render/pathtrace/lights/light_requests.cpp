#include "render/pathtrace/lights/light_requests.h"

namespace softreel {

void LightRequests::ask_other(const Receiver& receiver, const LightChoice& choice, const Vec2f& u, float share,
                              std::size_t event) {
  LightSample light;
  bool point_like = false;
  if (!lights_.sample_from(choice.light, receiver, choice.rest, u, light, point_like)) return;
  light.pdf *= choice.chance;
  light.radiance *= share;
  if (light.pdf > 0) others_.push_back({event, light, point_like});
}

}  // namespace softreel
