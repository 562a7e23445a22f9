/// Light samples that paths side by side ask for, answered lamp by lamp in vector instructions.
///
/// A sample of a near rectangle is a long chain of roots and divisions: of eight points at once it takes as long as of
/// one.
#pragma once

#include <array>
#include <vector>

#include "core/base/check.h"
#include "render/pathtrace/lights/light_set.h"

namespace softreel {

/// Of the events of one group of paths. What is answered has the bits of LightSet::sample and sample_light.
class LightRequests {
 public:
  /// Most points that may be asked from until the answer, for each light.
  static constexpr std::size_t kMost = RectangleSamples::kMost;

  explicit LightRequests(const LightSet& lights) : lights_(lights) {}

  /// A sample of every light; share: of its radiance that counts; event: the asker's number for the place.
  void ask_every(const Receiver& receiver, float choice, const Vec2f& u, float share, std::size_t event) {
    for (std::size_t k = 0; k < lights_.count(); ++k)
      if (lights_.may_reach(k, receiver)) ask(receiver, {k, 1, choice}, u, share, event);
  }
  /// A sample of one light, chosen as LightSet::sample does.
  void ask_one(const Receiver& receiver, float choice, const Vec2f& u, float share, std::size_t event) {
    LightChoice chosen;
    if (lights_.choose(receiver, choice, chosen)) ask(receiver, chosen, u, share, event);
  }

  /// Calls visit(event, light, point_like) for the samples that light comes from, and forgets them: of each event in an
  /// order that does not depend on the others.
  template <typename Visit>
  void answer(const Visit& visit);

 private:
  struct Asked {
    std::size_t event;
    float share, chance;
  };
  /// Samples of one rectangle, to be taken together.
  struct Lamp {
    RectangleSamples samples;
    std::array<Asked, kMost> asked;
  };
  struct Other {
    std::size_t event;
    LightSample light;
    bool point_like;
  };

  void ask(const Receiver& receiver, const LightChoice& choice, const Vec2f& u, float share, std::size_t event) {
    if (lights_.rectangle(choice.light) == nullptr) return ask_other(receiver, choice, u, share, event);
    while (lamps_.size() <= choice.light) lamps_.emplace_back();
    Lamp& lamp = lamps_[choice.light];
    CHECK(lamp.samples.count() < kMost);
    lamp.asked[lamp.samples.count()] = {event, share, choice.chance};
    lamp.samples.add(receiver.position, u);
  }
  void ask_other(const Receiver& receiver, const LightChoice& choice, const Vec2f& u, float share, std::size_t event);

  const LightSet& lights_;
  std::vector<Lamp> lamps_;  ///< by number of the light; as many as were asked for
  std::vector<Other> others_;
};

template <typename Visit>
void LightRequests::answer(const Visit& visit) {
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    Lamp& lamp = lamps_[k];
    if (lamp.samples.count() == 0) continue;
    const RectangleLight& light = *lights_.rectangle(k);
    light.sample(lamp.samples);
    for (std::size_t n = 0; n < lamp.samples.count(); ++n) {
      const Asked& asked = lamp.asked[n];
      LightSample sample = lamp.samples.sample(n);
      sample.radiance = light.radiance() * asked.share;
      sample.pdf *= asked.chance;
      if (sample.pdf > 0) visit(asked.event, sample, false);
    }
    lamp.samples.clear();
  }
  for (const Other& other : others_) visit(other.event, other.light, other.point_like);
  others_.clear();
}

}  // namespace softreel
