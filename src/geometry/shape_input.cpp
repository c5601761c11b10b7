#include "geometry/shape_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.hpp"
#include "geometry/combinations.hpp"
#include "geometry/primitives.hpp"
#include "geometry/revolved_profile.hpp"

namespace stirsph {
namespace {

using input::Parameters;
using input::Schema;

constexpr double infinity = std::numeric_limits<double>::infinity();

input::Entry& point(Schema& schema, const char* key, const char* doc) {
  return schema.reals(key, std::string(doc) + "; x, y and (0 when left out) z").unit("m").count(2, 3);
}

void declare_axis(Schema& schema, const char* origin, const char* doc) {
  point(schema, origin, doc).by_default("[\"0 m\", \"0 m\", \"0 m\"]");
  schema.reals("axis", "direction of the axis, of any length").count(3, 3).by_default("[0, 0, 1]");
}

std::optional<double> optional_height(const Parameters& p) {
  return p.has("height") ? std::optional(p.real("height")) : std::nullopt;
}

struct ShapeType {
  void (*declare)(Schema&);
  ShapePointer (*make)(const Parameters&);
};

void declare_half_space(Schema& s) {
  s.doc = "Everything on one side of a plane.";
  point(s, "point", "a point of the plane");
  s.reals("normal", "direction out of the solid, of any length; x, y and (0 when left out) z").count(2, 3);
}
ShapePointer make_half_space(const Parameters& p) {
  return std::make_shared<HalfSpace>(p.vector("point"), p.vector("normal"));
}

void declare_box(Schema& s) {
  s.doc = "A box along the axes, by `low` and `high` or by `centre` and `size`. With two coordinates: endless along z.";
  s.reals("low", "lowest corner; inf m is allowed").unit("m").count(2, 3).optional();
  s.reals("high", "highest corner; inf m is allowed").unit("m").count(2, 3).optional();
  s.reals("centre", "middle of the box").unit("m").count(2, 3).optional();
  s.reals("size", "edge lengths").unit("m").count(2, 3).positive().optional();
}
ShapePointer make_box(const Parameters& p) {
  const bool corners = p.has("low") && p.has("high"), middle = p.has("centre") && p.has("size");
  if (p.has("low") + p.has("high") + p.has("centre") + p.has("size") != 2 || corners == middle)
    p.fail("", "a box needs either low and high, or centre and size");
  const char* const first = corners ? "low" : "centre";
  const char* const second = corners ? "high" : "size";
  const auto a = p.reals(first), b = p.reals(second);
  if (a.size() != b.size()) p.fail(second, std::string("must have as many components as ") + first);
  Vec3 low = p.vector(first), high = p.vector(second);
  if (middle) {
    const Vec3 half = 0.5 * high;
    high = low + half;
    low = low - half;
  }
  if (a.size() == 2) {
    low.z = -infinity;
    high.z = infinity;
  }
  for (int i = 0; i < 3; ++i)
    if (!(low[i] < high[i])) p.fail(second, std::string("component ") + "xyz"[i] + " must be larger than that of low");
  return std::make_shared<Box>(low, high);
}

void declare_cylinder(Schema& s) {
  s.doc = "A solid cylinder; endless both ways without a height, which is a disc in two dimensions.";
  declare_axis(s, "base", "centre of the lower end, where the axis starts");
  s.real("radius", "radius").unit("m").positive();
  s.real("height", "length along the axis; endless when left out").unit("m").positive().optional();
}
ShapePointer make_cylinder_from(const Parameters& p) {
  return make_cylinder(p.vector("base"), p.vector("axis"), p.real("radius"), optional_height(p));
}

void declare_annulus(Schema& s) {
  s.doc = "A hollow cylinder; endless both ways without a height, which is a ring in two dimensions.";
  declare_axis(s, "base", "centre of the lower end, where the axis starts");
  s.real("inner_radius", "radius of the hole").unit("m").positive();
  s.real("outer_radius", "radius of the outer face").unit("m").positive();
  s.real("height", "length along the axis; endless when left out").unit("m").positive().optional();
}
ShapePointer make_annulus_from(const Parameters& p) {
  if (!(p.real("inner_radius") < p.real("outer_radius"))) p.fail("inner_radius", "must be smaller than outer_radius");
  return make_annulus(p.vector("base"), p.vector("axis"), p.real("inner_radius"), p.real("outer_radius"),
                      optional_height(p));
}

void declare_sphere(Schema& s) {
  s.doc = "A ball; a disc in two dimensions.";
  point(s, "centre", "centre").by_default("[\"0 m\", \"0 m\", \"0 m\"]");
  s.real("radius", "radius").unit("m").positive();
}
ShapePointer make_sphere(const Parameters& p) { return std::make_shared<Sphere>(p.vector("centre"), p.real("radius")); }

void declare_frustum(Schema& s) {
  s.doc = "A cone cut square to its axis; a whole cone with one radius 0.";
  declare_axis(s, "base", "centre of the lower end, where the axis starts");
  s.real("base_radius", "radius at the base").unit("m").not_negative();
  s.real("top_radius", "radius at the other end").unit("m").not_negative();
  s.real("height", "length along the axis").unit("m").positive();
}
ShapePointer make_frustum_from(const Parameters& p) {
  if (p.real("base_radius") == 0 && p.real("top_radius") == 0)
    p.fail("top_radius", "one of base_radius and top_radius must be > 0");
  return make_frustum(p.vector("base"), p.vector("axis"), p.real("base_radius"), p.real("top_radius"),
                      p.real("height"));
}

void declare_torus(Schema& s) {
  s.doc = "A ring of circular section.";
  declare_axis(s, "centre", "centre of the ring");
  s.real("ring_radius", "from the axis to the middle of the section").unit("m").positive();
  s.real("section_radius", "radius of the section").unit("m").positive();
}
ShapePointer make_torus(const Parameters& p) {
  if (!(p.real("section_radius") < p.real("ring_radius"))) p.fail("section_radius", "must be smaller than ring_radius");
  return std::make_shared<Torus>(p.vector("centre"), p.vector("axis"), p.real("ring_radius"), p.real("section_radius"));
}

void declare_profile(Schema& s) {
  s.doc =
      "A solid of revolution: a closed profile of straight lines turned about the axis. It may touch the axis, or stay "
      "away from it (a ring).";
  declare_axis(s, "base", "point of the axis where z of the profile is 0");
  Schema& vertex = s.tables("points", "corners of the profile in order around it, counted from 0 in messages", 3);
  vertex.real("r", "distance from the axis").unit("m").not_negative();
  vertex.real("z", "height along the axis from the base").unit("m");
  vertex.real("fillet", "radius that rounds the corner, outer or inner").unit("m").not_negative().by_default("0 m");
}
ShapePointer make_profile(const Parameters& p) {
  std::vector<RevolvedProfile::Vertex> vertices;
  std::string listed;
  for (const Parameters& v : p.tables("points")) {
    vertices.push_back({v.real("r"), v.real("z"), v.real("fillet")});
    listed += fmt::format(" ({}, {})", vertices.back().r, vertices.back().z);
  }
  try {
    return std::make_shared<RevolvedProfile>(p.vector("base"), p.vector("axis"), std::move(vertices),
                                             "profile through (r, z) [m]" + listed);
  } catch (const InputError& wrong) {
    p.fail("points", wrong.what());
  }
}

void declare_tool(Schema& s) {
  s.doc =
      "A tool: working face, land of full radius, shank relieved behind it, so that only the land rubs on the tube.";
  declare_axis(s, "base", "centre of the working face; the axis points from there to the shank");
  s.real("radius", "of the face and the land").unit("m").positive();
  s.real("height", "of the whole tool along the axis").unit("m").positive();
  s.real("land", "height of the full radius above the face; the whole height when left out")
      .unit("m")
      .positive()
      .optional();
  s.real("relief", "by how much the radius is smaller above the land").unit("m").not_negative().by_default("0 m");
  s.real("edge_fillet", "radius that rounds the edge of the face").unit("m").not_negative().by_default("0 m");
}
ShapePointer make_tool_from(const Parameters& p) {
  const double radius = p.real("radius"), height = p.real("height"), relief = p.real("relief");
  const double land = p.has("land") ? p.real("land") : height, fillet = p.real("edge_fillet");
  if (land > height) p.fail("land", fmt::format("must not be longer than the height of {:.6g} mm.", 1e3 * height));
  if (relief >= radius) p.fail("relief", fmt::format("must be smaller than the radius of {:.6g} mm.", 1e3 * radius));
  if (relief > 0 && land == height)
    p.fail(p.has("land") ? "land" : "relief",
           fmt::format("a relief needs a land shorter than the height of {:.6g} mm, such as land = \"2 mm\".",
                       1e3 * height));
  if (fillet > std::min(radius, land))
    p.fail("edge_fillet",
           fmt::format("there is no room for it. Allowed: up to {:.6g} mm, the smaller of radius and land.",
                       1e3 * std::min(radius, land)));
  return make_tool(p.vector("base"), p.vector("axis"), radius, land, relief, height, fillet);
}

void declare_die(Schema& s) {
  s.doc = "A die: a ring whose bore may be tapered, with a rounded rim at the far end.";
  declare_axis(s, "base", "centre of the lower end, where the axis starts");
  s.real("inner_radius", "radius of the bore at the base").unit("m").positive();
  s.real("outer_radius", "radius of the outer face").unit("m").positive();
  s.real("height", "length along the axis").unit("m").positive();
  s.real("taper", "half-angle by which the bore opens along the axis, such as \"0.5 deg\"; negative: it closes")
      .unit("rad")
      .range(-1.5, 1.5)
      .by_default("0 deg");
  s.real("edge_fillet", "radius that rounds the rim of the bore at the far end")
      .unit("m")
      .not_negative()
      .by_default("0 m");
}
ShapePointer make_die_from(const Parameters& p) {
  const double inner = p.real("inner_radius"), outer = p.real("outer_radius"), height = p.real("height");
  if (!(inner < outer)) p.fail("inner_radius", "must be smaller than outer_radius");
  const double top = inner + height * std::tan(p.real("taper"));
  if (!(top > 0 && top < outer))
    p.fail("taper", fmt::format("the bore would have a radius of {:.6g} mm at the far end. Allowed: > 0 and below the "
                                "outer radius of {:.6g} mm.",
                                1e3 * top, 1e3 * outer));
  try {
    return make_die(p.vector("base"), p.vector("axis"), inner, outer, height, p.real("taper"), p.real("edge_fillet"));
  } catch (const InputError& wrong) {  // all else is checked
    p.fail("edge_fillet", wrong.what());
  }
}

std::vector<ShapePointer> make_all(const std::vector<Parameters>& tables) {
  std::vector<ShapePointer> shapes;
  for (const auto& table : tables) shapes.push_back(make_shape(table));
  return shapes;
}

void declare_union(Schema& s) {
  s.doc = "Several shapes together.";
  s.variants("shapes", "type", shape_schemas, "the shapes joined").count(1, 15);
}
ShapePointer make_union(const Parameters& p) { return std::make_shared<Union>(make_all(p.tables("shapes"))); }

void declare_intersection(Schema& s) {
  s.doc = "What several shapes have in common: a half cylinder is a cylinder and a half space.";
  s.variants("shapes", "type", shape_schemas, "the shapes that overlap").count(1, 15);
}
ShapePointer make_intersection(const Parameters& p) {
  return std::make_shared<Intersection>(make_all(p.tables("shapes")));
}

void declare_difference(Schema& s) {
  s.doc = "A shape with others cut out of it.";
  s.variant("shape", "type", shape_schemas, "the shape that is cut");
  s.variants("remove", "type", shape_schemas, "the shapes cut out").count(1, 15);
}
ShapePointer make_difference(const Parameters& p) {
  return std::make_shared<Difference>(make_shape(p.table("shape")), make_all(p.tables("remove")));
}

/// The shapes that input files know: to add one, write its two functions and a line here.
const std::map<std::string, ShapeType>& shape_types() {
  static const std::map<std::string, ShapeType> types{
      {"annulus", {declare_annulus, make_annulus_from}},
      {"box", {declare_box, make_box}},
      {"cylinder", {declare_cylinder, make_cylinder_from}},
      {"die", {declare_die, make_die_from}},
      {"difference", {declare_difference, make_difference}},
      {"frustum", {declare_frustum, make_frustum_from}},
      {"half_space", {declare_half_space, make_half_space}},
      {"intersection", {declare_intersection, make_intersection}},
      {"profile", {declare_profile, make_profile}},
      {"sphere", {declare_sphere, make_sphere}},
      {"tool", {declare_tool, make_tool_from}},
      {"torus", {declare_torus, make_torus}},
      {"union", {declare_union, make_union}},
  };
  return types;
}

}  // namespace

const std::map<std::string, input::Schema>& shape_schemas() {
  static const std::map<std::string, Schema> schemas = [] {
    std::map<std::string, Schema> result;
    for (const auto& [name, type] : shape_types()) type.declare(result[name]);
    return result;
  }();
  return schemas;
}

ShapePointer make_shape(const input::Parameters& parameters) {
  for (const char* key : {"axis", "normal"}) {
    const auto& schema = shape_schemas().at(parameters.text("type"));
    if (schema.find(key) && !(norm(parameters.vector(key)) > 0))
      parameters.fail(key, "a direction must not be zero. Write for instance " + std::string(key) + " = [0, 0, 1]");
  }
  return shape_types().at(parameters.text("type")).make(parameters);
}

}  // namespace stirsph
