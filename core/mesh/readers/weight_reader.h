/// Painted weights: one number per vertex, from a text or PLY file.
#pragma once

#include <string>
#include <vector>

namespace softreel {

/// One number a line, in the order of the vertices; empty lines and lines that begin with '#' do not count.
/// From a .ply file: the property `attribute` of its vertices, "weight" if that is empty.
/// Throws input_error with the line for what is no number or not from 0 to 1, and for an attribute that the file does
/// not have, with the nearest one that it has.
std::vector<double> read_weights(const std::string& path, const std::string& attribute);

}  // namespace softreel
