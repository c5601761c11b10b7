// The only file that knows the Gmsh library: mesh_file.hpp and mesh_shape.hpp.
//
// Gmsh and OpenCASCADE compare lengths with absolute tolerances of about 1e-7 made for millimetres, so shapes are built
// in mm and their meshes scaled to m afterwards.
#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/timer.hpp"
#include "geometry/about_axis.hpp"
#include "geometry/combinations.hpp"
#include "geometry/mesh_file.hpp"
#include "geometry/mesh_shape.hpp"
#include "geometry/mesh_sizes.hpp"
#include "geometry/primitives.hpp"
#include "geometry/revolved_profile.hpp"

namespace stirsph {
namespace {

namespace occ = gmsh::model::occ;
using Entities = gmsh::vectorpair;  // (dimension, tag)

constexpr double mm = 1e-3, per_m = 1e3;  // m; model units per metre
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Gmsh started once, silent, on one thread.
class GmshSession {
 public:
  static void start() { static const GmshSession session; }
  ~GmshSession() { gmsh::finalize(); }

 private:
  GmshSession() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    // The size callback alone decides: no extension of sizes from the boundary into the volume, none from points.
    gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
    gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
    gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", 0);
    gmsh::option::setNumber("Mesh.Renumber", 1);
  }
};

/// A model of its own that leaves nothing behind.
class Model {
 public:
  Model() {
    gmsh::model::add("stirsph");
    gmsh::logger::start();
  }
  ~Model() {
    gmsh::model::mesh::removeSizeCallback();
    gmsh::logger::stop();
    gmsh::model::remove();
  }
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  /// Errors Gmsh reported without throwing; empty when there are none.
  std::string errors() const {
    std::vector<std::string> log;
    gmsh::logger::get(log);
    std::string text;
    for (const auto& line : log)
      if (line.starts_with("Error")) text += (text.empty() ? "" : "; ") + line;
    return text;
  }
};

/// Runs a function in a new model; whatever Gmsh throws becomes a Failure with its text.
template <class Failure, class Function>
auto in_gmsh(const std::string& what, Function function) {
  std::string reason;
  try {
    GmshSession::start();
    const Model model;
    return function(model);
  } catch (const Error&) {
    throw;
  } catch (const std::string& text) {
    reason = text;
  } catch (const std::exception& error) {
    reason = error.what();
  } catch (int) {
    gmsh::logger::getLastError(reason);
  }
  throw Failure(fmt::format("{}: Gmsh says: {}", what, reason.empty() ? "nothing about the reason" : reason));
}

// ---- from Gmsh's model to a mesh ----------------------------------------------------------------------------------

using FacetKey = std::array<std::int32_t, 3>;
FacetKey sorted_key(std::array<std::int32_t, 3> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

struct NodeMap {
  std::vector<std::int32_t> index;  ///< by Gmsh's tag; -1: not in the mesh
  std::int32_t operator[](std::size_t tag) const { return tag < index.size() ? index[tag] : -1; }
};

void append_elements(SimplexMesh& mesh, std::vector<std::size_t>& corner_tags, int entity) {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> tags, nodes;
  gmsh::model::mesh::getElements(types, tags, nodes, mesh.dim, entity);
  const int wanted = mesh.dim == 3 ? 4 : 2;  // Gmsh's types of the linear tetrahedron and triangle
  for (std::size_t t = 0; t < types.size(); ++t) {
    if (types[t] != wanted) {
      std::string name;
      int dim, order, count, primary;
      std::vector<double> local;
      gmsh::model::mesh::getElementProperties(types[t], name, dim, order, count, local, primary);
      throw InputError(fmt::format("{}: element {} is a {}. Allowed: linear {} only", mesh.source, tags[t].front(),
                                   name, mesh.dim == 3 ? "tetrahedra (4 nodes)" : "triangles (3 nodes)"));
    }
    mesh.element_numbers.insert(mesh.element_numbers.end(), tags[t].begin(), tags[t].end());
    corner_tags.insert(corner_tags.end(), nodes[t].begin(), nodes[t].end());
  }
}

/// Nodes and elements of some entities; nodes in the order of their numbers, only those that elements use.
NodeMap take_elements(SimplexMesh& mesh, const std::vector<int>& entities, double scale) {
  std::vector<std::size_t> corner_tags, node_tags;
  for (const int entity : entities) append_elements(mesh, corner_tags, entity);
  std::vector<double> coordinates, unused;
  gmsh::model::mesh::getNodes(node_tags, coordinates, unused);
  std::size_t largest = 0;
  for (const auto tag : node_tags) largest = std::max(largest, tag);
  for (const auto tag : corner_tags) largest = std::max(largest, tag);
  std::vector<std::size_t> place(largest + 1, node_tags.size());
  for (std::size_t i = 0; i < node_tags.size(); ++i) place[node_tags[i]] = i;
  NodeMap map{std::vector<std::int32_t>(largest + 1, -1)};
  for (const auto tag : corner_tags) map.index[tag] = 0;
  for (std::size_t tag = 0; tag <= largest; ++tag) {
    if (map.index[tag] < 0) continue;
    if (place[tag] == node_tags.size())
      throw InputError(fmt::format("{}: an element names node {}, which is not in the file", mesh.source, tag));
    const double* x = &coordinates[3 * place[tag]];
    map.index[tag] = static_cast<std::int32_t>(mesh.nodes.size());
    mesh.nodes.push_back(scale * Vec3{x[0], x[1], x[2]});
    mesh.node_numbers.push_back(static_cast<std::int64_t>(tag));
  }
  const int corners = mesh.corners();
  for (std::size_t e = 0; e < mesh.element_numbers.size(); ++e) {
    std::array<std::int32_t, 4> element{-1, -1, -1, -1};
    for (int i = 0; i < corners; ++i) element[i] = map[corner_tags[corners * e + i]];
    mesh.elements.push_back(element);
  }
  // A file whose elements all turn the other way follows another convention; only a mixture is an error.
  bool all_negative = true;
  for (std::size_t e = 0; e < mesh.elements.size() && all_negative; ++e) all_negative = element_volume(mesh, e) < 0;
  if (all_negative)
    for (auto& element : mesh.elements) std::swap(element[1], element[2]);
  return map;
}

/// Turns the facets that Gmsh keeps on some entities into a surface group; facets inside the body are left out.
void take_group(SimplexMesh& mesh, const NodeMap& map, const std::map<FacetKey, std::int32_t>& facets,
                const std::string& name, const std::vector<int>& entities) {
  SurfaceGroup group{name, {}};
  for (const int entity : entities) {
    std::vector<std::size_t> tags, nodes;
    gmsh::model::mesh::getElementsByType(mesh.dim == 3 ? 2 : 1, tags, nodes, entity);
    for (std::size_t i = 0; i < tags.size(); ++i) {
      FacetKey key{-1, -1, -1};
      for (int k = 0; k < mesh.dim; ++k) key[k] = map[nodes[mesh.dim * i + k]];
      const auto found = facets.find(sorted_key(key));
      if (found != facets.end()) group.facets.push_back(found->second);
    }
  }
  std::sort(group.facets.begin(), group.facets.end());
  group.facets.erase(std::unique(group.facets.begin(), group.facets.end()), group.facets.end());
  if (!group.facets.empty()) mesh.groups.push_back(std::move(group));
}

std::map<FacetKey, std::int32_t> facet_index(const SimplexMesh& mesh) {
  std::map<FacetKey, std::int32_t> facets;
  for (std::size_t f = 0; f < mesh.surface.size(); ++f) facets[sorted_key(mesh.surface[f])] = f;
  return facets;
}

std::string physical_name(int dim, int tag) {
  std::string name;
  gmsh::model::getPhysicalName(dim, tag, name);
  return name.empty() ? std::to_string(tag) : name;
}

/// The entities to read: those of a named physical group, or all.
std::vector<int> chosen_entities(const SimplexMesh& mesh, const std::string& body) {
  std::vector<int> entities;
  Entities all;
  if (body.empty()) {
    gmsh::model::getEntities(all, mesh.dim);
    for (const auto& [dim, tag] : all) entities.push_back(tag);
    return entities;
  }
  gmsh::model::getPhysicalGroups(all, mesh.dim);
  std::string known;
  for (const auto& [dim, tag] : all) {
    const std::string name = physical_name(dim, tag);
    known += (known.empty() ? "" : ", ") + name;
    if (name == body) gmsh::model::getEntitiesForPhysicalGroup(dim, tag, entities);
  }
  if (entities.empty())
    throw InputError(fmt::format("{}: no body called \"{}\". The file's bodies: {}", mesh.source, body,
                                 known.empty() ? "none is named" : known));
  return entities;
}

void expect_mesh_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: the mesh file cannot be opened", path));
  std::string line;
  double version = 0;
  while (line.empty() && std::getline(file, line))
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
  // Gmsh guesses other formats from the name and would even run a script: only its own mesh format gets that far.
  if (line != "$MeshFormat" || !(file >> version))
    throw InputError(fmt::format("{}: not a mesh file: it does not begin with $MeshFormat", path));
  if (version != 2.2 && version != 4.1)
    throw InputError(fmt::format("{}: the mesh file has version {}. Allowed: 2.2 and 4.1", path, version));
  if (std::filesystem::path(path).extension() != ".msh")
    throw InputError(fmt::format("{}: the name of a mesh file must end in .msh", path));
}

// ---- from shapes to Gmsh's solids ---------------------------------------------------------------------------------

/// Builds a shape in the model, in mm. What is endless reaches beyond a ball around the region of interest.
class SolidBuilder final : public ShapeVisitor {
 public:
  SolidBuilder(const Vec3& centre, double reach) : centre_(centre), reach_(reach) {}

  Entities build(const ShapeFunction& shape) {
    shape.accept(*this);
    return std::move(solid_);
  }

  void visit(const HalfSpace& shape) override {
    const Vec3 normal = shape.normal();
    const double height = dot(centre_ - per_m * shape.point(), normal), depth = 2 * reach_ + std::abs(height);
    // A slab below the plane z = 0, turned so that z becomes the normal, under the middle of the region.
    const int box = occ::addBox(-2 * reach_, -2 * reach_, -depth, 4 * reach_, 4 * reach_, depth);
    solid_ = {{3, box}};
    turn_from_z(normal);
    move(centre_ - height * normal);
  }
  void visit(const Box& shape) override {
    const Bounds bounds = shape.bounds();
    Vec3 low, size;
    for (int i = 0; i < 3; ++i) {
      low[i] = std::max(per_m * bounds.low[i], centre_[i] - 2 * reach_);
      size[i] = std::min(per_m * bounds.high[i], centre_[i] + 2 * reach_) - low[i];
      if (size[i] <= 0) return;  // beyond the region
    }
    solid_ = {{3, occ::addBox(low.x, low.y, low.z, size.x, size.y, size.z)}};
  }
  void visit(const Sphere& shape) override {
    const Vec3 c = per_m * shape.centre();
    solid_ = {{3, occ::addSphere(c.x, c.y, c.z, per_m * shape.radius())}};
  }
  void visit(const Torus& shape) override {
    solid_ = {{3, occ::addTorus(0, 0, 0, per_m * shape.ring_radius(), per_m * shape.section_radius())}};
    turn_from_z(shape.axis());
    move(per_m * shape.centre());
  }
  void visit(const EndlessTube& shape) override {
    const Vec3 base = per_m * shape.base(), axis = shape.axis(), along = 4 * reach_ * axis;
    const Vec3 start = base + (dot(centre_ - base, axis) - 2 * reach_) * axis;
    const auto rod = [&](double radius) -> Entities {
      return {{3, occ::addCylinder(start.x, start.y, start.z, along.x, along.y, along.z, per_m * radius)}};
    };
    solid_ = rod(shape.outer_radius());
    if (shape.inner_radius() > 0) subtract(rod(shape.inner_radius()));
  }
  void visit(const RevolvedProfile& shape) override {
    const Vec3 base = per_m * shape.base(), axis = shape.axis(), radial = across(axis);
    const auto point = [&](double r, double z) {
      const Vec3 p = base + per_m * (r * radial + z * axis);
      return occ::addPoint(p.x, p.y, p.z);
    };
    const auto& edges = shape.edges();
    std::vector<int> points, lines;
    for (const auto& edge : edges) points.push_back(point(edge.start_r, edge.start_z));
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const int start = points[i], end = points[(i + 1) % edges.size()];
      lines.push_back(edges[i].radius > 0 ? occ::addCircleArc(start, point(edges[i].centre_r, edges[i].centre_z), end)
                                          : occ::addLine(start, end));
    }
    const int section = occ::addPlaneSurface({occ::addWire(lines)});
    Entities swept;
    occ::revolve({{2, section}}, base.x, base.y, base.z, axis.x, axis.y, axis.z, 2 * std::numbers::pi, swept);
    for (const auto& entity : swept)
      if (entity.first == 3) solid_.push_back(entity);
  }
  void visit(const Union& shape) override {
    Entities sum;
    for (const auto& member : shape.members()) {
      const Entities next = SolidBuilder(centre_, reach_).build(*member);
      if (sum.empty() || next.empty()) {
        sum.insert(sum.end(), next.begin(), next.end());
        continue;
      }
      Entities joined;
      std::vector<Entities> history;
      occ::fuse(sum, next, joined, history);
      sum = joined;
    }
    solid_ = sum;
  }
  void visit(const Intersection& shape) override {
    for (std::size_t i = 0; i < shape.members().size(); ++i) {
      const Entities next = SolidBuilder(centre_, reach_).build(*shape.members()[i]);
      solid_ = i == 0 ? next : common(solid_, next);
    }
  }
  void visit(const Difference& shape) override {
    solid_ = SolidBuilder(centre_, reach_).build(shape.shape());
    for (const auto& removed : shape.removed()) subtract(SolidBuilder(centre_, reach_).build(*removed));
  }

  static Entities common(const Entities& a, const Entities& b) {
    if (a.empty() || b.empty()) return {};
    Entities result;
    std::vector<Entities> history;
    occ::intersect(a, b, result, history);
    return result;
  }

 private:
  void subtract(const Entities& removed) {
    if (solid_.empty() || removed.empty()) return;
    Entities result;
    std::vector<Entities> history;
    occ::cut(solid_, removed, result, history);
    solid_ = result;
  }
  void turn_from_z(const Vec3& direction) {
    const Vec3 axis = cross(Vec3{0, 0, 1}, direction);
    const double angle = std::atan2(norm(axis), direction.z);
    if (norm(axis) > 0)
      occ::rotate(solid_, 0, 0, 0, axis.x, axis.y, axis.z, angle);
    else if (direction.z < 0)
      occ::rotate(solid_, 0, 0, 0, 1, 0, 0, std::numbers::pi);
  }
  void move(const Vec3& by) { occ::translate(solid_, by.x, by.y, by.z); }

  Vec3 centre_;
  double reach_;
  Entities solid_;
};

Entities solid_of(const ShapeFunction& shape, const ShapeMeshOptions& options) {
  const Bounds metres = meshed_region(shape, options), region{per_m * metres.low, per_m * metres.high};
  const Vec3 centre = 0.5 * (region.low + region.high);
  const double reach = norm(region.high - region.low);
  Entities solid = SolidBuilder(centre, reach).build(shape);
  Vec3 low = centre - 2 * reach * Vec3{1, 1, 1}, size = 4 * reach * Vec3{1, 1, 1};
  if (options.axisymmetric) low.x = 0;
  if (options.cut)
    for (int k = 0; k < options.dimensions; ++k) {
      const int i = mesh_axes(options)[k];
      low[i] = region.low[i];
      size[i] = region.high[i] - region.low[i];
    }
  if (options.axisymmetric) {
    // In the opposite half-plane, where the surfaces of turned solids have no seam.
    Entities section{{2, occ::addRectangle(low.x, low.z, 0, size.x, size.z)}};
    occ::rotate(section, 0, 0, 0, 1, 0, 0, 0.5 * std::numbers::pi);
    occ::rotate(section, 0, 0, 0, 0, 0, 1, std::numbers::pi);
    return SolidBuilder::common(solid, section);
  }
  if (options.dimensions == 2)
    return SolidBuilder::common(solid, {{2, occ::addRectangle(low.x, low.y, 0, size.x, size.y)}});
  return options.cut ? SolidBuilder::common(solid, {{3, occ::addBox(low.x, low.y, low.z, size.x, size.y, size.z)}})
                     : solid;
}

/// What building left over (sections that were turned, tools that touched nothing) must not be meshed.
void keep_only(const Entities& solid, int dim) {
  for (int d = 3; d >= dim - 1; --d) {
    Entities all, kept = d == dim ? solid : Entities{};
    if (d == dim - 1) gmsh::model::getBoundary(solid, kept, false, false, false);
    gmsh::model::getEntities(all, d);
    std::erase_if(all, [&](const auto& entity) { return std::find(kept.begin(), kept.end(), entity) != kept.end(); });
    gmsh::model::removeEntities(all, true);
  }
}

/// Gmsh's fast mesher (HXT) puts points where the layout of memory leads it, even on one thread; its older one always
/// gives the same mesh.
void generate(int dim, bool fast) {
  constexpr int hxt = 10, delaunay = 1;
  gmsh::option::setNumber("Mesh.Algorithm3D", fast ? hxt : delaunay);
  gmsh::model::mesh::generate(dim);
}

}  // namespace

SimplexMesh read_mesh_file(const std::string& path, const MeshFileOptions& options) {
  expect_mesh_file(path);
  if (!(options.scale > 0)) throw InputError(fmt::format("{}: the scale of a mesh must be > 0", path));
  return in_gmsh<InputError>(path, [&](const Model& model) {
    gmsh::merge(path);
    if (const auto errors = model.errors(); !errors.empty()) throw InputError(path + ": Gmsh says: " + errors);
    SimplexMesh mesh;
    mesh.dim = options.dimensions;
    mesh.source = path;
    mesh.axisymmetric = options.axisymmetric;
    const NodeMap map = take_elements(mesh, chosen_entities(mesh, options.body), options.scale);
    if (mesh.axisymmetric)
      lay_into_half_plane(mesh);
    else if (mesh.dim == 2)
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n].z != 0)
          throw InputError(fmt::format("{}: node {} lies at z = {} m. A mesh in two dimensions lies in the plane z = 0",
                                       path, mesh.node_number(n), mesh.nodes[n].z));
    extract_surface(mesh);
    const auto facets = facet_index(mesh);
    Entities groups;
    gmsh::model::getPhysicalGroups(groups, mesh.dim - 1);
    for (const auto& [dim, tag] : groups) {
      std::vector<int> entities;
      gmsh::model::getEntitiesForPhysicalGroup(dim, tag, entities);
      take_group(mesh, map, facets, physical_name(dim, tag), entities);
    }
    return mesh;
  });
}

void write_mesh_file(const SimplexMesh& mesh, const std::string& path, MeshFileFormat format) {
  if (std::filesystem::path(path).extension() != ".msh")
    throw IoError(fmt::format("{}: the name of a mesh file must end in .msh", path));
  in_gmsh<IoError>(path, [&](const Model& model) {
    const bool binary = format == MeshFileFormat::Binary2 || format == MeshFileFormat::Binary4;
    const bool old = format == MeshFileFormat::Text2 || format == MeshFileFormat::Binary2;
    gmsh::option::setNumber("Mesh.Binary", binary);
    gmsh::option::setNumber("Mesh.MshFileVersion", old ? 2.2 : 4.1);
    gmsh::option::setNumber("Mesh.SaveAll", 0);
    const int body = gmsh::model::addDiscreteEntity(mesh.dim);
    std::vector<std::size_t> tags(mesh.nodes.size()), nodes;
    std::vector<double> coordinates;
    for (std::size_t n = 0; n < tags.size(); ++n) {
      tags[n] = static_cast<std::size_t>(mesh.node_number(n));
      coordinates.insert(coordinates.end(), {mesh.nodes[n].x, mesh.nodes[n].y, mesh.nodes[n].z});
    }
    gmsh::model::mesh::addNodes(mesh.dim, body, tags, coordinates);
    std::vector<std::size_t> element_tags(mesh.elements.size());
    std::int64_t last = 0;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      element_tags[e] = static_cast<std::size_t>(mesh.element_number(e));
      last = std::max(last, mesh.element_number(e));
      for (int i = 0; i < mesh.corners(); ++i) nodes.push_back(tags[mesh.elements[e][i]]);
    }
    gmsh::model::mesh::addElementsByType(body, mesh.dim == 3 ? 4 : 2, element_tags, nodes);
    gmsh::model::addPhysicalGroup(mesh.dim, {body});
    std::vector<bool> written(mesh.surface.size());
    for (const auto& group : mesh.groups) {
      const int entity = gmsh::model::addDiscreteEntity(mesh.dim - 1);
      element_tags.clear();
      nodes.clear();
      for (const auto facet : group.facets) {
        if (written[facet]) continue;
        written[facet] = true;
        element_tags.push_back(static_cast<std::size_t>(++last));
        for (int i = 0; i < mesh.dim; ++i) nodes.push_back(tags[mesh.surface[facet][i]]);
      }
      if (element_tags.empty()) continue;
      gmsh::model::mesh::addElementsByType(entity, mesh.dim == 3 ? 2 : 1, element_tags, nodes);
      gmsh::model::setPhysicalName(mesh.dim - 1, gmsh::model::addPhysicalGroup(mesh.dim - 1, {entity}), group.name);
    }
    gmsh::write(path);
    if (const auto errors = model.errors(); !errors.empty()) throw IoError(path + ": Gmsh says: " + errors);
  });
}

ShapeMesh mesh_shape(const ShapePointer& shape, const ShapeMeshOptions& options) {
  check_mesh_options(options);
  const double start = wall_seconds();
  return in_gmsh<InputError>(shape->describe(), [&](const Model&) {
    const int dim = options.dimensions;
    check_element_count(*shape, options);
    const Entities solid = solid_of(*shape, options);
    if (solid.empty()) throw InputError(shape->describe() + ": nothing of it is left to mesh");
    occ::synchronize();
    keep_only(solid, dim);
    gmsh::model::mesh::setSizeCallback([&](int, int, double x, double y, double z) {
      const Vec3 place = mm * Vec3{x, y, z};
      return per_m * edge_length_at(options.sizes, options.axisymmetric ? turned_into_half_plane(place) : place);
    });
    generate(dim, options.fast);

    ShapeMesh result{};
    SimplexMesh& mesh = result.mesh;
    mesh.dim = dim;
    mesh.source = "mesh of the " + shape->describe();
    std::vector<int> bodies;
    for (const auto& entity : solid) bodies.push_back(entity.second);
    mesh.axisymmetric = options.axisymmetric;
    const NodeMap map = take_elements(mesh, bodies, mm);
    if (mesh.elements.empty())
      throw InputError(fmt::format("{}: Gmsh could not mesh it at sizes {} m to {} m", shape->describe(),
                                   options.sizes.near, options.sizes.far));
    // Sections are built to the rounding of solids.
    if (mesh.axisymmetric) {
      // Turned over from the opposite half-plane. Orientation and radius change their sign, the volume of a ring, by
      // which take_elements orients the elements, does not.
      for (Vec3& node : mesh.nodes) node.x = -node.x;
      lay_into_half_plane(mesh);
    } else if (dim == 2) {
      for (Vec3& node : mesh.nodes) node.z = 0;
    }
    mesh.node_numbers.clear();
    mesh.element_numbers.clear();
    extract_surface(mesh);
    const auto facets = facet_index(mesh);
    Entities faces;
    gmsh::model::getBoundary(solid, faces, true, false, false);
    for (const auto& entity : faces)
      take_group(mesh, map, facets, fmt::format("face {}", mesh.groups.size() + 1), {entity.second});
    result.worst_quality = 1;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e)
      result.worst_quality = std::min(result.worst_quality, element_quality(mesh, e));
    if (options.cut) {
      Bounds cut = *options.cut;
      if (dim == 2) cut.low[mesh_axes(options)[2]] = -infinity, cut.high[mesh_axes(options)[2]] = infinity;
      if (mesh.axisymmetric) cut.low.x = std::min(cut.low.x, -cut.high.x);  // a section ends at the axis by itself
      const std::vector<ShapePointer> both{shape, std::make_shared<Box>(cut.low, cut.high)};
      result.surface_gap = surface_gap(mesh, Intersection(both));
    } else {
      result.surface_gap = surface_gap(mesh, *shape);
    }
    result.meshing_seconds = wall_seconds() - start;
    return result;
  });
}

double surface_gap(const SimplexMesh& mesh, const ShapeFunction& shape) {
  double gap = 0;
  const auto look_at = [&](const Vec3& point) { gap = std::max(gap, std::abs(shape.distance(point))); };
  for (std::size_t f = 0; f < mesh.surface.size(); ++f) {
    look_at(facet_centroid(mesh, f));
    if (mesh.dim == 3)
      for (int i = 0; i < 3; ++i)
        look_at(0.5 * (mesh.nodes[mesh.surface[f][i]] + mesh.nodes[mesh.surface[f][(i + 1) % 3]]));
  }
  return gap;
}

}  // namespace stirsph
