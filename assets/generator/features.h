/// Eyes and mouths: details pressed into a surface without undercuts, so that a lattice of their size resolves them.
#pragma once

#include "core/base/types.h"

namespace softreel::sculpt {

/// A ball with an upper and a lower lid, a bowl for the pupil and a bead in it that catches the light. Lengths in m.
struct Eye {
  Vec3 center = Vec3::Zero();
  double radius = 0.06;
  Vec3 look = Vec3::UnitZ();          ///< unit
  Vec3 lid_normal = Vec3::UnitY();    ///< unit, up: tilts the edges of the lids
  double upper = 0.03, lower = 0.04;  ///< from the centre to the edges of the lids, along lid_normal
  double pupil = 0.03;                ///< radius of the bowl
  double ramp = 0.012;                ///< width of every step
};

double eye_ball(const Vec3& p, const Eye& eye);

/// An arc in the x-y plane, open upwards, pressed into whatever faces +z there.
struct Smile {
  double center_y = 0, radius = 0.1;  ///< of the arc's circle, on x = 0
  double half_angle = 0.9;            ///< rad, from straight down to a corner of the mouth
  double min_z = 0;                   ///< the back of the head stays as it is
  double width = 0.01, depth = 0.01;
};

/// What to add to a distance to press the smile in.
double smile_depth(const Vec3& p, const Smile& smile);

/// 0 below -1/2, 1 above 1/2, smooth between.
double ramp(double x);

}  // namespace softreel::sculpt
