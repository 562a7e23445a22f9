/// What presents a body in its first shot: solver, camera, lamps, surroundings, ground, picture.
#pragma once

#include <string>

#include "tool/starter/starter_choices.h"

namespace softreel {

/// These tables as TOML, for a body of about a metre, with room in the picture for where it is pulled.
std::string stage_for(const StarterBody& body);

}  // namespace softreel
