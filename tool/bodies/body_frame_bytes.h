/// One body at one frame as the cache keeps it.
#pragma once

#include <optional>
#include <span>

#include "tool/bodies/simulate_stage.h"
#include "tool/cache/cache.h"

namespace softreel {

/// State, sub-steps and energy; what a run counts is not kept.
Bytes pack(const BodyFrame& frame);
BodyFrame unpack_body_frame(std::span<const std::uint8_t> bytes);

/// The energy of a stored frame; none if there is no such frame, or a softreel that did not measure it stored it. Reads
/// all of the frame.
std::optional<FrameEnergy> stored_energy(const Cache& cache, const StageKey& frame_key);

}  // namespace softreel
