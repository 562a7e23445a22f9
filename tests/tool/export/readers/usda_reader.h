/// A reader of the text form of USD for tests, written from its grammar: prims with attributes, relationships and time
/// samples. No composition, no dictionaries.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace softreel::testing {

/// A number, a string, a path, an asset, a tuple or a list.
struct UsdValue {
  enum class Kind { None, Number, Text, Path, Asset, Tuple, List } kind = Kind::None;
  double number = 0;
  std::string text;  ///< of texts, paths and assets
  std::vector<UsdValue> items;

  /// All numbers inside, in order, as float32.
  std::vector<float> floats() const;
  std::vector<double> doubles() const;
};

struct UsdProperty {
  std::string type;
  UsdValue value;
  std::map<double, UsdValue> samples;
  std::map<std::string, UsdValue> metadata;
};

struct UsdPrim {
  std::string type, name;
  std::map<std::string, UsdValue> metadata;
  std::map<std::string, UsdProperty> properties;
  std::vector<std::unique_ptr<UsdPrim>> children;

  /// Throw std::runtime_error if there is none of the name; a child of "a/b" is b of a.
  const UsdPrim& child(const std::string& path) const;
  const UsdProperty& property(const std::string& property_name) const;
};

/// The stage as a prim without name, whose metadata are those of the file. Throws std::runtime_error with the line
/// where the text leaves the grammar.
std::unique_ptr<UsdPrim> read_usda(const std::string& text);

}  // namespace softreel::testing
