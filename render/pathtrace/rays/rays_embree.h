/// Rays in the form that Embree takes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>

#include <embree3/rtcore.h>

#include "render/pathtrace/rays/ray_scene.h"

namespace softreel {

inline RTCIntersectContext new_context(RTCIntersectContextFlags flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

/// Four floats that are stored at once.
using Quad [[gnu::vector_size(16)]] = float;

/// By quads, as Embree loads them: loads of what was stored by parts wait until the stores are through.
inline void set_ray(const Ray& ray, RTCRay& out) {
  const Quad from{ray.origin.x(), ray.origin.y(), ray.origin.z(), 0};
  const Quad along{ray.direction.x(), ray.direction.y(), ray.direction.z(), ray.time};
  auto* const to = reinterpret_cast<char*>(&out);
  std::memcpy(to + offsetof(RTCRay, org_x), &from, sizeof from);
  std::memcpy(to + offsetof(RTCRay, dir_x), &along, sizeof along);
  out.tfar = ray.max_distance;
  out.mask = 0xffffffffu;
  out.id = 0;
  out.flags = 0;
}

static_assert(kRayPacket == 8);

/// Which lanes of a packet hold rays.
struct alignas(32) Lanes {
  std::array<int, kRayPacket> valid{};

  explicit Lanes(std::size_t count) { std::fill_n(valid.begin(), count, -1); }
};

/// Empty lanes hold the last ray again: no arithmetic with what happens to be in memory. rays: one at least.
inline void set_rays(std::span<const Ray> rays, RTCRay8& out) {
  for (std::size_t k = 0; k < kRayPacket; ++k) {
    const Ray& ray = rays[std::min(k, rays.size() - 1)];
    out.org_x[k] = ray.origin.x();
    out.org_y[k] = ray.origin.y();
    out.org_z[k] = ray.origin.z();
    out.dir_x[k] = ray.direction.x();
    out.dir_y[k] = ray.direction.y();
    out.dir_z[k] = ray.direction.z();
    out.time[k] = ray.time;
    out.tfar[k] = ray.max_distance;
  }
  std::fill_n(out.tnear, kRayPacket, 0.0f);
  std::fill_n(out.mask, kRayPacket, 0xffffffffu);
  std::fill_n(out.id, kRayPacket, 0u);
  std::fill_n(out.flags, kRayPacket, 0u);
}

}  // namespace softreel
