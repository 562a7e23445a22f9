/// Sweeps of a batch: fields that take several values, and the variants of a shot that all combinations of them make.
#pragma once

#include <string>
#include <vector>

#include "tool/shot/shot_load.h"

namespace softreel {

/// One --sweep PATH=VALUE,VALUE,...
struct SweepAxis {
  std::string path;
  std::vector<std::string> values;  ///< TOML or bare words, as in --set; all different
};

/// Splits "path=a,b,c" at the commas outside brackets, braces and quotes. A value A..B/N stands for N numbers equally
/// far apart, A..B/Nlog for N numbers by equal factors, both with A and B among them. Throws input_error for anything
/// else, for a value that is there twice, and for a path that no shot has, naming the nearest.
SweepAxis parse_sweep(const std::string& text);

/// One combination.
struct Variant {
  std::vector<Override> values;  ///< in the order of the axes, as given by --sweep
  std::string name;              ///< "path=value,path=value", good as a folder's name; empty where nothing is swept
};

/// All combinations, the last axis running fastest; one without values if there are no axes. A name depends on the
/// variant's own values only, so that a longer sweep keeps the folders of a shorter one. Throws input_error for a path
/// given twice, and for more than `limit` combinations.
std::vector<Variant> expand_sweeps(const std::vector<SweepAxis>& axes, std::size_t limit);

}  // namespace softreel
