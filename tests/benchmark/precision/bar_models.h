/// Bars that are clamped in exact planes, as bodies for any stepper.
#pragma once

#include <vector>

#include "core/dynamics/simulator.h"

namespace softreel::bench {

enum class Clamped { LowEnd, BothEnds };

/// Surface points of its model: the nodes of the free bar, in order, and behind them points of the clamps.
struct Bar {
  BodyModel model;
  double length = 0, width = 0;  ///< m
};

/// A bar of square section along x from 0 to slenderness * width, its axis at y = z = 0, of `across` cubes of BCC
/// tetrahedra across. Each clamped end is covered by tetrahedra beyond it, all of whose nodes are pinned: of the bar
/// itself exactly the nodes in the end's plane are held, so that its length is that of the theory. Pin 0 is the low
/// end, pin 1 the high one.
Bar make_clamped_bar(Index across, int slenderness, double width, const ElementMaterial& material, Clamped clamped);

/// Nodes in the section at x: those at the corners of cubes, which lie symmetrically about the axis.
std::vector<Index> section_nodes(const Bar& bar, double x);

/// Mean displacement of nodes, m.
Vec3 mean_displacement(const Bar& bar, const std::vector<Index>& nodes, std::span<const Vec3> positions);

/// Turn of a section about the bar's axis, rad, if it is small: least squares over its nodes.
double section_twist(const Bar& bar, const std::vector<Index>& nodes, std::span<const Vec3> positions);

/// A dead load on nodes in equal shares: a pull towards a target 1e4 lengths away with a limited force, whose direction
/// turns by 1e-4 of what the nodes move over the length.
Pull make_dead_load(const Bar& bar, const std::vector<Index>& nodes, const Vec3& force);

}  // namespace softreel::bench
