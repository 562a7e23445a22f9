/// The presets and materials that come with the program, found from where it lies.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// The folder presets/: $SOFTREEL_PRESETS, else that of an installed program (../share/softreel/presets from it), else
/// that of the sources it was built in. Empty if there is none. Throws input_error if $SOFTREEL_PRESETS holds no
/// materials.
std::string preset_folder();

/// Names of the library's materials and of the preset shots, sorted; none where the library is not found.
std::vector<std::string> library_materials();
std::vector<std::string> library_presets();

/// The file of a material. Throws input_error for an unknown name, naming the nearest, and where there is no library.
std::string material_file(const std::string& name);

/// The file of a quality: of the library by its name (draft, preview, final), or any file by its path, which ends in
/// .toml. Throws input_error.
std::string quality_file(const std::string& name);

/// The file of a preset: of the library by its name, or any shot by its path. Throws input_error.
std::string preset_file(const std::string& name);

}  // namespace softreel
