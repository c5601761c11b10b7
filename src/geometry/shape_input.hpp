/// Shapes in input files: `type = "cylinder"` and the keys of each type.
#pragma once

#include <map>
#include <string>

#include "geometry/shape.hpp"
#include "input/parameters.hpp"

namespace stirsph {

/// The known types with their keys, for input::Schema::variant(key, "type", shape_schemas, doc).
const std::map<std::string, input::Schema>& shape_schemas();

/// The shape of a checked variant table. Throws InputError naming the key when values do not fit together.
ShapePointer make_shape(const input::Parameters& parameters);

}  // namespace stirsph
