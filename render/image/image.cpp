#include "render/image/image.h"

namespace softreel {

const Channel* Image::find(const std::string& name) const {
  for (const Channel& channel : channels)
    if (channel.name == name) return &channel;
  return nullptr;
}

}  // namespace softreel
