/// A batch as one HTML page that needs nothing else: no script, no file, no network.
#pragma once

#include <string>
#include <vector>

#include "tool/batch/batch_result.h"
#include "tool/batch/job_pictures.h"

namespace softreel {

/// pictures: as batch.jobs. when, host: words. Readable in the dark, in the light and on paper.
std::string batch_page(const BatchResult& batch, const std::vector<JobPictures>& pictures, const std::string& when,
                       const std::string& host);

/// "4 done, 1 failed"
std::string counts_text(const BatchResult& batch);

}  // namespace softreel
