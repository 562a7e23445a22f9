// Samples taken side by side against those taken one by one.
#include "render/pathtrace/lights/light_requests.h"

#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

namespace softreel {
namespace {

AreaLight lamp(LampShape shape, const Vec3f& center, float half) {
  AreaLight light;
  light.shape = shape;
  light.center = center;
  light.u = Vec3f(half, 0, 0);
  light.v = Vec3f(0, 0, half);
  if (light.u.cross(light.v).y() > 0) light.v = -light.v;
  light.radiance = Vec3f(3, 2, 1);
  return light;
}

/// Two rectangles with a disk between them, and a sun.
Scene scene_of_lights() {
  Scene scene;
  scene.area_lights = {lamp(LampShape::Rectangle, Vec3f(0, 2, 0), 0.7f), lamp(LampShape::Disk, Vec3f(1, 3, 0), 0.4f),
                       lamp(LampShape::Rectangle, Vec3f(-3, 1, 1), 0.1f)};
  scene.suns.emplace_back();
  return scene;
}

class Places {
 public:
  Receiver receiver() {
    Receiver receiver;
    receiver.position = 3 * vector();
    receiver.normal = vector().normalized();
    return receiver;
  }
  Vec2f point() { return {number(), number()}; }
  float number() { return 0.5f * (at_(rng_) + 1); }

 private:
  Vec3f vector() { return {at_(rng_), at_(rng_), at_(rng_)}; }
  std::uniform_real_distribution<float> at_{-1, 0x1.fffffep-1f};
  std::mt19937 rng_{2008};
};

struct Answer {
  Vec3f direction, radiance;
  float distance, pdf;
  bool point_like;
};

bool equal(const Answer& a, const Answer& b) {
  return a.direction == b.direction && a.radiance == b.radiance && a.distance == b.distance && a.pdf == b.pdf &&
         a.point_like == b.point_like;
}

/// What paths are answered, by event, with `company` events asked for together.
std::multimap<std::size_t, Answer> answers(const LightSet& lights, bool every, std::size_t events,
                                           std::size_t company) {
  LightRequests requests(lights);
  std::multimap<std::size_t, Answer> found;
  Places places;
  for (std::size_t first = 0; first < events; first += company) {
    for (std::size_t event = first; event < std::min(events, first + company); ++event) {
      const Receiver receiver = places.receiver();
      const float choice = places.number();
      const Vec2f u = places.point();
      if (every)
        requests.ask_every(receiver, choice, u, 0.5f, event);
      else
        requests.ask_one(receiver, choice, u, 0.5f, event);
    }
    requests.answer([&](std::size_t event, const LightSample& light, bool point_like) {
      found.emplace(event, Answer{light.direction, light.radiance, light.distance, light.pdf, point_like});
    });
  }
  return found;
}

void expect_those_taken_one_by_one(bool every) {
  const Scene scene = scene_of_lights();
  const LightSet lights(scene);
  constexpr std::size_t kEvents = 2000;
  const auto found = answers(lights, every, kEvents, 48);
  Places places;
  std::size_t expected = 0;
  for (std::size_t event = 0; event < kEvents; ++event) {
    const Receiver receiver = places.receiver();
    const float choice = places.number();
    const Vec2f u = places.point();
    const auto [begin, end] = found.equal_range(event);
    for (std::size_t k = 0; k < (every ? lights.count() : 1); ++k) {
      LightSample light;
      bool point_like = false;
      if (!(every ? lights.sample_light(k, receiver, choice, u, light, point_like)
                  : lights.sample(receiver, choice, u, light, point_like)))
        continue;
      ++expected;
      const Answer one{light.direction, light.radiance * 0.5f, light.distance, light.pdf, point_like};
      EXPECT_TRUE(std::any_of(begin, end, [&](const auto& entry) { return equal(entry.second, one); })) << event;
    }
  }
  EXPECT_EQ(found.size(), expected);
  EXPECT_GT(expected, kEvents / 4);
}

TEST(LightRequests, OfEveryLightAreThoseTakenOneByOne) {
  expect_those_taken_one_by_one(true);
}

TEST(LightRequests, OfAChosenLightAreThoseTakenOneByOne) {
  expect_those_taken_one_by_one(false);
}

TEST(LightRequests, DoNotDependOnWhoElseAsks) {
  const Scene scene = scene_of_lights();
  const LightSet lights(scene);
  const auto alone = answers(lights, true, 300, 1), together = answers(lights, true, 300, 37);
  ASSERT_EQ(alone.size(), together.size());
  for (auto a = alone.begin(), b = together.begin(); a != alone.end(); ++a, ++b) {
    EXPECT_EQ(a->first, b->first);
    EXPECT_TRUE(equal(a->second, b->second)) << "of each event in the same order";
  }
}

}  // namespace
}  // namespace softreel
