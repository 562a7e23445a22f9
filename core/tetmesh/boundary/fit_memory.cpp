#include "core/tetmesh/boundary/fit_memory.h"

namespace softreel {
namespace {

/// The same whatever the order of the corners.
std::uint64_t face_key(const std::array<Vec3, 3>& corners) {
  return position_hash(corners[0]) + position_hash(corners[1]) + position_hash(corners[2]);
}

}  // namespace

Index FitMemory::find_step(const Vec3& before) const {
  return table_.find(position_hash(before),
                     [&](Index number) { return steps_[static_cast<std::size_t>(number)][0] == before; });
}

void FitMemory::add(const Vec3& before, const Vec3& after) {
  if (find_step(before) >= 0) return;
  steps_.push_back({before, after});
  table_.insert(static_cast<Index>(steps_.size() - 1),
                [&](Index number) { return position_hash(steps_[static_cast<std::size_t>(number)][0]); });
}

void FitMemory::set_sample_faces(const std::vector<std::array<Vec3, 3>>& faces,
                                 const std::vector<Index>& sample_faces) {
  std::vector<Index> numbers;
  numbers.reserve(faces.size());
  for (const auto& corners : faces) numbers.push_back(face_keys_.insert(face_key(corners)).first);
  sample_faces_.reserve(sample_faces.size());
  for (const Index face : sample_faces) sample_faces_.push_back(numbers[static_cast<std::size_t>(face)]);
}

void FitMemory::find_sample_faces(const std::vector<std::array<Vec3, 3>>& faces,
                                  std::vector<Index>& sample_faces) const {
  if (sample_faces_.size() != sample_faces.size()) return;
  std::vector<Index> now(static_cast<std::size_t>(face_keys_.size()), -1);
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (const Index then = face_keys_.find(face_key(faces[f])); then >= 0)
      now[static_cast<std::size_t>(then)] = static_cast<Index>(f);
  for (std::size_t s = 0; s < sample_faces.size(); ++s)
    sample_faces[s] = now[static_cast<std::size_t>(sample_faces_[s])];
}

const Vec3* FitMemory::find(const Vec3& before) const {
  const Index number = find_step(before);
  return number >= 0 ? &steps_[static_cast<std::size_t>(number)][1] : nullptr;
}

}  // namespace softreel
