/// How the one table of fields is written down: a field names a member and a codec, and from the two come reading,
/// checking, writing and the reference.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "tool/shot/schema.h"
#include "tool/shot/toml_tree.h"

namespace softreel {

/// Where the reader is: a field of the shot. Problems are collected, so that one run shows them all.
struct Place {
  std::string path;                 ///< "body.creature.pin[0].keys"
  const FieldText* text = nullptr;  ///< what the table says of the field; null: of the whole document
  std::vector<std::string>* problems = nullptr;

  /// A part of this field under the same description: "[1]", ".value".
  Place part(const std::string& suffix) const { return {path + suffix, text, problems}; }
  /// The entry of this list at a position.
  Place item(std::size_t index) const;
};

/// The five-part error for a value: `reason` completes "FIELD = VALUE is wrong because ...". What is accepted and what
/// to do next come from the field's description; `next` replaces the latter.
Error value_error(const Place& place, const TomlValue& value, const std::string& reason, const std::string& next = {});

/// The error for a field that `table`, whose value is given, lacks.
Error missing_error(const Place& table, const TomlValue& value, const FieldText& field);

/// The error for a name that a table does not have, with the nearest one it has.
Error unknown_field_error(const Place& table, const TomlEntry& entry, const std::vector<std::string>& known);

/// ", did you mean 'x'?" or nothing.
std::string suggestion(const std::string& unknown, const std::vector<std::string>& known);

/// How a value of type T is read from and written to TOML.
template <typename T>
struct Codec {
  std::string type;      ///< "number", "[x, y, z]"
  std::string accepted;  ///< "above 0"
  /// Throws value_error.
  std::function<T(const Place&, const TomlValue&)> parse;
  /// None: the value is said by leaving the field out.
  std::function<std::optional<TomlValue>(const T&)> print;
  std::vector<FieldText> parts;  ///< of values that have fields of their own; paths start with '.' or '['
};

/// One field of a struct S.
template <typename S>
struct Field {
  FieldText text;                ///< its path is its name
  std::vector<FieldText> parts;  ///< of fields inside it; paths start with '.' or '['
  std::function<void(const Place&, const TomlValue&, S&)> read;
  std::function<std::optional<TomlValue>(const S&)> write;
};

template <typename S>
struct Table;

template <typename S>
void read_table(const Table<S>& table, const Place& place, const TomlValue& value, S& out);
template <typename S>
TomlValue write_table(const Table<S>& table, const S& in);
/// Descriptions of a table's fields, each path after `prefix`.
template <typename S>
std::vector<FieldText> table_texts(const Table<S>& table, const std::string& prefix);

/// The fields of a struct S and what must hold between them.
template <typename S>
struct Table {
  std::string sentence;
  std::vector<Field<S>> fields;
  /// Called after the fields are read without a problem; completes values that depend on others. Throws value_error.
  std::function<void(const Place&, const TomlValue&, S&)> check;

  /// A plain field. `access` gives the member, const or not: a member pointer or a generic lambda. The default in the
  /// reference is that of S unless `default_value` says it in words.
  template <typename Access, typename T>
  Table& add(const std::string& name, Access access, const Codec<T>& codec, const std::string& unit,
             const std::string& meaning, const std::string& default_value = {}) {
    Field<S> field;
    field.text = {name, codec.type, unit, default_value, codec.accepted, meaning, false, false};
    field.parts = codec.parts;
    field.read = [access, parse = codec.parse](const Place& place, const TomlValue& value, S& out) {
      std::invoke(access, out) = parse(place, value);
    };
    field.write = [access, print = codec.print](const S& in) { return print(std::invoke(access, in)); };
    if (default_value.empty())
      if (const auto value = field.write(*std::make_unique<S>())) field.text.default_value = to_text(*value);
    fields.push_back(std::move(field));
    return *this;
  }

  /// A field that must be given.
  template <typename Access, typename T>
  Table& require(const std::string& name, Access access, const Codec<T>& codec, const std::string& unit,
                 const std::string& meaning) {
    add(name, access, codec, unit, meaning, "must be given");
    fields.back().text.required = true;
    return *this;
  }

  /// [name]: one table.
  template <typename Access, typename Inner>
  Table& add_table(const std::string& name, Access access, const Table<Inner>& inner) {
    Field<S> field = table_field(name, "table", inner.sentence);
    field.parts = table_texts(inner, ".");
    field.read = [access, &inner](const Place& place, const TomlValue& value, S& out) {
      read_table(inner, place, value, std::invoke(access, out));
    };
    field.write = [access, &inner](const S& in) -> std::optional<TomlValue> {
      return as_section(write_table(inner, std::invoke(access, in)));
    };
    fields.push_back(std::move(field));
    return *this;
  }

  /// [name]: a table whose presence matters; the member is a std::optional.
  template <typename Access, typename Inner>
  Table& add_optional_table(const std::string& name, Access access, const Table<Inner>& inner) {
    Field<S> field = table_field(name, "table", inner.sentence);
    field.parts = table_texts(inner, ".");
    field.read = [access, &inner](const Place& place, const TomlValue& value, S& out) {
      read_table(inner, place, value, std::invoke(access, out).emplace());
    };
    field.write = [access, &inner](const S& in) -> std::optional<TomlValue> {
      const auto& member = std::invoke(access, in);
      if (!member) return std::nullopt;
      return as_section(write_table(inner, *member));
    };
    fields.push_back(std::move(field));
    return *this;
  }

  /// [[name]]: any number of tables; the member is a std::vector.
  template <typename Access, typename Inner>
  Table& add_list(const std::string& name, Access access, const Table<Inner>& inner) {
    Field<S> field = table_field(name, "list of tables", inner.sentence);
    field.parts = table_texts(inner, "[].");
    field.read = [access, &inner](const Place& place, const TomlValue& value, S& out) {
      if (value.array() == nullptr) throw value_error(place, value, "it is " + kind_name(value));
      auto& items = std::invoke(access, out);
      for (const TomlValue& item : *value.array()) {
        const Place at = place.item(items.size());
        read_table(inner, at, item, items.emplace_back());
      }
    };
    field.write = [access, &inner](const S& in) -> std::optional<TomlValue> {
      TomlValue::Array items;
      for (const auto& item : std::invoke(access, in)) items.push_back(as_section(write_table(inner, item)));
      if (items.empty()) return std::nullopt;
      return as_section(toml_value(std::move(items)));
    };
    fields.push_back(std::move(field));
    return *this;
  }

  /// [name.KEY]: tables by name. `insert(S&, key)` gives the struct of a new name, `each(const S&, visit)` calls
  /// visit(key, struct) for all of them.
  template <typename Inner, typename Insert, typename Each>
  Table& add_named(const std::string& name, Insert insert, Each each, const Table<Inner>& inner) {
    Field<S> field = table_field(name, "tables by name", inner.sentence);
    field.parts = table_texts(inner, ".*.");
    field.read = [insert, &inner](const Place& place, const TomlValue& value, S& out) {
      if (value.table() == nullptr) throw value_error(place, value, "it is " + kind_name(value));
      for (const TomlEntry& entry : *value.table())
        read_table(inner, place.part("." + key_text(entry.key)), entry.value, insert(out, entry.key));
    };
    field.write = [each, &inner](const S& in) -> std::optional<TomlValue> {
      TomlValue::Table entries;
      each(in, [&](const std::string& key, const Inner& item) {
        entries.push_back(toml_entry(key, as_section(write_table(inner, item))));
      });
      if (entries.empty()) return std::nullopt;
      return as_section(toml_value(std::move(entries)));
    };
    fields.push_back(std::move(field));
    return *this;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Field<S>& field : fields) all.push_back(field.text.path);
    return all;
  }

 private:
  static Field<S> table_field(const std::string& name, const std::string& type, const std::string& sentence) {
    Field<S> field;
    field.text = {name, type, "", "", type == "list of tables" ? "a list of tables" : "a table", sentence, true, false};
    return field;
  }
  static TomlValue as_section(TomlValue value) {
    value.section = true;
    return value;
  }
};

template <typename S>
void read_table(const Table<S>& table, const Place& place, const TomlValue& value, S& out) {
  if (value.table() == nullptr) throw value_error(place, value, "it is " + kind_name(value));
  if constexpr (requires { out.origin = value.origin; }) out.origin = value.origin;
  const std::size_t problems_before = place.problems->size();
  const auto collect = [&place](const auto& work) {
    try {
      work();
    } catch (const Error& error) {
      place.problems->emplace_back(error.what());
    }
  };
  for (const TomlEntry& entry : *value.table()) {
    collect([&] {
      for (const Field<S>& field : table.fields) {
        if (field.text.path != entry.key) continue;
        const std::string path = place.path.empty() ? entry.key : place.path + "." + entry.key;
        return field.read({path, &field.text, place.problems}, entry.value, out);
      }
      throw unknown_field_error(place, entry, table.names());
    });
  }
  for (const Field<S>& field : table.fields)
    if (field.text.required && value.find(field.text.path) == nullptr)
      collect([&] { throw missing_error(place, value, field.text); });
  if (table.check && place.problems->size() == problems_before) collect([&] { table.check(place, value, out); });
}

template <typename S>
TomlValue write_table(const Table<S>& table, const S& in) {
  TomlValue::Table entries;
  for (const Field<S>& field : table.fields)
    if (auto value = field.write(in)) entries.push_back(toml_entry(field.text.path, std::move(*value)));
  return toml_value(std::move(entries));
}

template <typename S>
std::vector<FieldText> table_texts(const Table<S>& table, const std::string& prefix) {
  std::vector<FieldText> texts;
  for (const Field<S>& field : table.fields) {
    texts.push_back(field.text);
    texts.back().path = prefix + field.text.path;
    for (const FieldText& part : field.parts) {
      texts.push_back(part);
      texts.back().path = prefix + field.text.path + part.path;
    }
  }
  return texts;
}

}  // namespace softreel
