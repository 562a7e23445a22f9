/// The tables that make up the schema, one function each; they live as long as the program and never change.
#pragma once

#include "tool/shot/schema_table.h"
#include "tool/shot/shot.h"

namespace softreel {

/// The whole document.
const Table<Shot>& shot_table();

const Table<BodySettings>& body_table();
const Table<MaterialSettings>& material_table();
const Table<GlueSettings>& glue_table();
/// What must hold between glue and the rest of the shot. Throws value_error.
void check_glues(const Shot& shot, const Place& place, const TomlValue& value);

const Table<Shot>& solver_table();
/// The ways to find the rotations of elements, by name.
Codec<RotationMethod> rotation_method();

const Table<CameraSettings>& camera_table();
const Table<LightSettings>& light_table();
const Table<SkySettings>& sky_table();
const Table<Shot>& environment_table();
const Table<Ground>& ground_table();
const Table<RenderSettings>& render_table();
const Table<OutputSettings>& output_table();

/// Textures and vertex colours of a material; where one of them is given, the one value that it replaces is not
/// written.
void add_texture_fields(Table<MaterialSettings>& table);
/// What is shown as heat.
void add_heat_fields(Table<RenderSettings>& table);

/// Fields of a table of which at most one may be given; in a later layer one takes the place of the others.
struct Alternatives {
  std::string table;  ///< "body.*"
  std::vector<std::string> fields;
};
const std::vector<Alternatives>& alternatives();

/// The field's value if it says something: a switch that is off is no alternative to anything. Null if there is none.
const TomlValue* find_given(const TomlValue& table, const std::string& name);

/// Throws the error for two alternatives of a table that are both given; `pattern` is the table's path in the schema.
void check_alternatives(const Place& place, const TomlValue& value, const std::string& pattern);

}  // namespace softreel
