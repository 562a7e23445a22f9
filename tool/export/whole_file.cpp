#include "tool/export/whole_file.h"

namespace softreel {
namespace {

class WholeFile : public ExportWriter {
 public:
  WholeFile(EncodeSurface encode, ExportTarget target) : encode_(std::move(encode)), target_(std::move(target)) {}
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
