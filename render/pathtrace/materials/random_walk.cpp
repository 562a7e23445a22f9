#include "render/pathtrace/materials/random_walk.h"

#include <algorithm>
#include <cmath>

#include "render/pathtrace/rays/sampling.h"

namespace softreel {

namespace {

/// Scatterings: in a half-space of albedo 0.999, 1 % of the light has not left after 1000.
constexpr int kMostSteps = 1000;
/// From here on scattering is isotropic: at g = 0.9, 24 scatterings leave 8 % of the first direction.
constexpr int kIsotropicStart = 24;
/// Walks of this length may be ended by chance.
constexpr int kWalkRouletteStart = 16;
/// Surfaces of one body on one flight; beyond them the mesh is taken to be broken.
constexpr int kMostSurfaces = 64;

/// Cosine of a scattering by Henyey and Greenstein.
float phase_cosine(float g, float u) {
  if (std::abs(g) < 1e-3f) return 1 - 2 * u;
  const float s = (1 - g * g) / (1 + g - 2 * g * u);
  return std::clamp((1 + g * g - s * s) / (2 * g), -1.0f, 1.0f);
}

Vec3f scattered(const Vec3f& direction, float g, const Vec2f& u) {
  const float cosine = phase_cosine(g, u.x()), angle = 2 * kPi * u.y();
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const ShadingFrame frame(direction);
  return frame.to_world(Vec3f(sine * std::cos(angle), sine * std::sin(angle), cosine)).normalized();
}

/// The medium without anisotropy, but with the same absorption and transport length.
ScatteringMedium isotropic(const ScatteringMedium& medium) {
  const Vec3f kept = Vec3f::Ones() - medium.anisotropy * medium.albedo;
  ScatteringMedium result;
  result.extinction = medium.extinction.cwiseProduct(kept);
  result.albedo = ((1 - medium.anisotropy) * medium.albedo).cwiseQuotient(kept);
  return result;
}

/// One walk in the making.
class Walk {
 public:
  Walk(const RayScene& rays, Index mesh, const ScatteringMedium& medium, const WalkStart& start, RandomStream& numbers)
      : rays_(rays), mesh_(mesh), medium_(medium), numbers_(numbers), ray_(start.ray) {
    chance_ = start.importance / start.importance.sum();
    channel_ = start.choice < chance_[0] ? 0 : start.choice < chance_[0] + chance_[1] ? 1 : 2;
    if (!(chance_[channel_] > 0)) chance_.maxCoeff(&channel_);  // the rounding of the sum
  }

  bool run(float first, WalkExit& exit) {
    for (int step = 0; step < kMostSteps; ++step) {
      bool left = false;
      if (!fly(step == 0 ? first : numbers_.next(), left)) return false;
      if (left) return finish(exit);
      scattered_ = scattered_.cwiseProduct(medium_.albedo);
      if (!survives(step)) return false;
      if (step == kIsotropicStart) medium_ = isotropic(medium_);
      ray_.direction = scattered(ray_.direction, medium_.anisotropy, Vec2f(numbers_.next(), numbers_.next()));
    }
    ray_.max_distance = std::numeric_limits<float>::infinity();
    bool left = false;
    return reach_surface(left) && left && finish(exit);
  }

 private:
  /// To the next collision, or out; false if the mesh is broken.
  bool fly(float u, bool& left) {
    const float length = -std::log1p(-u) / medium_.extinction[channel_];
    ray_.max_distance = length;
    travelled_ = 0;
    if (!reach_surface(left)) return false;
    const float distance = left ? travelled_ : length;
    const Vec3f more = medium_.extinction - Vec3f::Constant(medium_.extinction[channel_]);
    ratio_ = ratio_.cwiseProduct((-distance * more).array().exp().matrix());
    if (!left) ratio_ = ratio_.cwiseProduct(medium_.extinction / medium_.extinction[channel_]);
    ratio_ = (ratio_.array() < 1e-20f).select(0.0f, ratio_);
    return true;
  }

  /// Moves to the end of the ray or to where it leaves the body; false if the mesh is broken.
  bool reach_surface(bool& left) {
    for (int k = 0; k < kMostSurfaces; ++k) {
      RayHit hit;
      bool front = false;
      if (!rays_.intersect_body(mesh_, ray_, hit, front)) {
        if (!std::isfinite(ray_.max_distance)) return false;
        ray_.origin += ray_.max_distance * ray_.direction;
        left = false;
        return true;
      }
      travelled_ += hit.distance;
      depth_ += front ? 1 : -1;
      if (depth_ == 0) {
        hit_ = hit;
        left = true;
        return true;
      }
      // Just beyond the surface, by the rounding of its coordinates.
      const float beyond = hit.distance + 1e-6f * (ray_.origin.cwiseAbs().maxCoeff() + hit.distance);
      ray_.origin += beyond * ray_.direction;
      ray_.max_distance = std::max(0.0f, ray_.max_distance - hit.distance);
    }
    return false;
  }

  /// A walk goes on with the chance of what a channel carries times the fourth root of its ratio over the largest one.
  /// With that ratio itself, channels that are unlikely now and likely later get weights of a thousand; without it,
  /// walks that carry next to nothing take all their steps.
  bool survives(int step) {
    if (!(scattered_.cwiseProduct(ratio_).maxCoeff() > 0)) return false;
    if (step < kWalkRouletteStart) return true;
    const Vec3f likely = (ratio_ / ratio_.maxCoeff()).cwiseSqrt().cwiseSqrt();
    const float chance = std::min(1.0f, scattered_.cwiseProduct(likely).maxCoeff());
    if (numbers_.next() >= chance) return false;
    scattered_ /= chance;
    return true;
  }

  bool finish(WalkExit& exit) const {
    exit = {hit_, ray_, scattered_.cwiseProduct(ratio_) / chance_.dot(ratio_)};
    return true;
  }

  const RayScene& rays_;
  Index mesh_;
  ScatteringMedium medium_;
  RandomStream& numbers_;
  Ray ray_;
  RayHit hit_;
  int depth_ = 1;                    ///< solids around the point
  float travelled_ = 0;              ///< m, of this flight up to its last surface
  Vec3f chance_;                     ///< of each channel to be the one that sets lengths
  Index channel_ = 0;                ///< the one that does
  Vec3f ratio_ = Vec3f::Ones();      ///< density of this walk, had a channel set its lengths, over what it is
  Vec3f scattered_ = Vec3f::Ones();  ///< product of the albedos
};

}  // namespace

RandomStream::RandomStream(std::uint64_t seed) {
  // The finaliser of SplitMix64 (Steele, Lea and Flood 2014): near seeds give streams that have nothing in common.
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebu;
  state_ = seed ^ (seed >> 31);
}

std::uint32_t RandomStream::step() {
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005u + 1442695040888963407u;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
  const auto turn = static_cast<std::uint32_t>(old >> 59u);
  return (shifted >> turn) | (shifted << ((32 - turn) & 31u));
}

float RandomStream::next() {
  return static_cast<float>(step() >> 8) * 0x1p-24f;
}

ScatteringMedium medium_of(const Subsurface& subsurface) {
  const float g = subsurface.anisotropy;
  ScatteringMedium medium;
  medium.anisotropy = g;
  for (int c = 0; c < 3; ++c) {
    const float A = std::clamp(subsurface.color[c], 0.0f, 1.0f);
    // A = (1 - s)(1 - 0.139 s) / (1 + 1.17 s), s^2 = (1 - albedo) / (1 - g albedo). The smaller root, without
    // cancellation at A near 1.
    const float b = 1.139f + 1.17f * A;
    const float s = 2 * (1 - A) / (b + std::sqrt(b * b - 4 * 0.139f * (1 - A)));
    const float albedo = (1 - s * s) / (1 - g * s * s);
    const float width = 1.9f - A + 3.5f * (A - 0.8f) * (A - 0.8f);
    medium.albedo[c] = albedo;
    medium.extinction[c] = 1 / (subsurface.radius[c] * width * (1 - g * albedo));
  }
  return medium;
}

bool random_walk(const RayScene& rays, Index mesh, const ScatteringMedium& medium, const WalkStart& start,
                 RandomStream& numbers, WalkExit& exit) {
  if (!(start.importance.sum() > 0)) return false;
  return Walk(rays, mesh, medium, start, numbers).run(start.first, exit);
}

}  // namespace softreel
