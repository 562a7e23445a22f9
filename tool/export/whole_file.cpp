#include "tool/export/whole_file.h"

#include <limits>

#include <fmt/format.h>

#include "tool/export/float_values.h"

namespace softreel {
namespace {

class WholeFile : public ExportWriter {
 public:
  WholeFile(EncodeSurface encode, ExportTarget target) : encode_(std::move(encode)), target_(std::move(target)) {
    for (const ExportBody& body : target_.bodies)
      require_texture_coordinates(fmt::format("{}, body {}", target_.shot, body.name), *body.mesh,
                                  std::numeric_limits<double>::max());
  }
  void append(const ExportSample& sample) override {
    target_.sink(encode_(*target_.bodies[sample.body].mesh, sample.positions, sample.normals));
  }
  void finish() override {}

 private:
  EncodeSurface encode_;
  ExportTarget target_;
};

}  // namespace

std::function<std::unique_ptr<ExportWriter>(ExportTarget)> whole_file_writer(EncodeSurface encode) {
  return [encode = std::move(encode)](ExportTarget target) {
    return std::make_unique<WholeFile>(encode, std::move(target));
  };
}

}  // namespace softreel
