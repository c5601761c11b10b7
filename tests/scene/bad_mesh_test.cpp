/// Wrong meshes of rigid bodies and wrong heat conditions in scene files: each is refused on all ranks before the first
/// step, with a message that names the place, the element or surface, and the remedy.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "driver/probes.hpp"
#include "driver/simulation.hpp"
#include "geometry/mesh_file.hpp"
#include "geometry/mesh_shape.hpp"
#include "geometry/primitives.hpp"
#include "scene/scene.hpp"

namespace stirsph {
namespace {

/// A scene that works; each case replaces one piece of it. MESHES is the folder of the mesh files.
const std::string good = R"toml(
mechanics = false
[numerics]
spacing = "1 mm"
[time]
end = "1 s"
step = "0.05 s"
[[material]]
name = "AL"
file = "materials/aa2024_t351.toml"
[[material]]
name = "H13"
file = "materials/aisi_h13.toml"
[[body]]
name = "billet"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "0 mm"], high = ["6 mm", "4 mm", "4 mm"] }
temperature = "600 K"
[[rigid]]
name = "die"
material = "H13"
shape = { type = "box", low = ["-2 mm", "-2 mm", "-5 mm"], high = ["8 mm", "6 mm", "0 mm"] }
[rigid.heat]
role = "mesh"
conductance = "1000 W/m2/K"
mesh = { file = "MESHES/die.msh", scale = 1e-3, body = "die" }
[[rigid.heat.surface]]
group = "bottom"
temperature = "300 K"
[[rigid.heat.surface]]
region = { type = "box", low = ["-3 mm", "-3 mm", "-6 mm"], high = ["-1.9 mm", "9 mm", "1 mm"] }
flux = "1e5 W/m2"
[[rigid]]
name = "plate"
shape = { type = "half_space", point = ["0 mm", "0 mm", "4 mm"], normal = [0, 0, -1] }
heat = { role = "fixed", temperature = "300 K", conductance = "1000 W/m2/K" }
[[heat_source]]
on = ["billet", "die"]
density = "1e6 W/m3"
[[probe]]
name = "thermocouple"
kind = "point"
rigid = "die"
position = ["3 mm", "2 mm", "-2 mm"]
[heat]
mode = "conduction"
)toml";

const std::string folder = std::string(STIRSPH_SOURCE_DIR) + "/inputs";

const std::string& meshes() {
  static const std::string path = std::string(STIRSPH_BINARY_DIR) + "/bad_mesh_test_" + std::to_string(Comm().size());
  return path;
}

constexpr double mm = 1e-3;

/// On a mesh in mm: "bottom" and, for an edge of two conditions, "side".
void add_groups(SimplexMesh& mesh) {
  add_group(mesh, "bottom", [](const Vec3& centroid, const Vec3&) { return centroid.z < -4.99; });
  add_group(mesh, "side", [](const Vec3& centroid, const Vec3&) { return centroid.x > 7.99; });
}

/// Tetrahedra of the die, lengths in mm.
SimplexMesh die_in_mm() {
  ShapeMeshOptions options;
  options.sizes.near = options.sizes.far = 2 * mm;
  SimplexMesh mesh =
      mesh_shape(std::make_shared<Box>(Vec3{-2 * mm, -2 * mm, -5 * mm}, Vec3{8 * mm, 6 * mm, 0}), options).mesh;
  for (Vec3& node : mesh.nodes) node = 1e3 * node;
  mesh.groups.clear();
  add_groups(mesh);
  return mesh;
}

void move(SimplexMesh& mesh, const Vec3& by) {
  for (Vec3& node : mesh.nodes) node += by;
}

/// A flat tetrahedron glued to a facet of the bottom.
void add_needle(SimplexMesh& mesh) {
  const std::int32_t facet = find_group(mesh, "bottom")->facets.front();
  const auto corners = mesh.surface[facet];
  mesh.nodes.push_back(facet_centroid(mesh, facet) + Vec3{0, 0, -1e-3});
  mesh.elements.push_back({corners[0], corners[1], corners[2], static_cast<std::int32_t>(mesh.nodes.size() - 1)});
}

/// The elements beyond x = 3 mm get nodes of their own: two parts that only seem to touch.
void double_nodes(SimplexMesh& mesh) {
  std::vector<std::int32_t> own(mesh.nodes.size(), -1);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    double middle = 0;
    for (const auto node : mesh.elements[e]) middle += 0.25 * mesh.nodes[node].x;
    if (middle < 3) continue;
    for (auto& node : mesh.elements[e]) {
      if (own[node] < 0) {
        own[node] = static_cast<std::int32_t>(mesh.nodes.size());
        mesh.nodes.push_back(mesh.nodes[node]);
      }
      node = own[node];
    }
  }
}

/// No elements where the middle of the billet touches.
void make_hole(SimplexMesh& mesh) {
  std::erase_if(mesh.elements, [&](const auto& element) {
    Vec3 middle;
    for (const auto node : element) middle += 0.25 * mesh.nodes[node];
    return norm(middle - Vec3{3, 2, 0}) < 2.5;
  });
  extract_surface(mesh);
  add_groups(mesh);
}

void write_meshes() {
  const Comm comm;
  comm.together([&] {
    if (!comm.is_root()) return;
    std::filesystem::create_directories(meshes());
    // Written as version 2 text: the name of the physical volume is put in by hand.
    const auto write = [&](const std::string& name, auto&& spoil) {
      SimplexMesh mesh = die_in_mm();
      spoil(mesh);
      write_mesh_file(mesh, meshes() + "/" + name, MeshFileFormat::Text2);
      std::ifstream in(meshes() + "/" + name);
      std::string text((std::istreambuf_iterator<char>(in)), {});
      const std::string names = "$PhysicalNames\n2\n";
      const std::size_t at = text.find(names);
      if (at != std::string::npos) text.replace(at, names.size(), "$PhysicalNames\n3\n3 1 \"die\"\n");
      std::ofstream(meshes() + "/" + name) << text;
    };
    write("die.msh", [](SimplexMesh&) {});
    write("inverted.msh", [](SimplexMesh& mesh) { std::swap(mesh.elements[4][0], mesh.elements[4][1]); });
    write("needle.msh", add_needle);
    write("double.msh", double_nodes);
    write("hole.msh", make_hole);
    write("overlapping.msh", [](SimplexMesh& mesh) { move(mesh, {0, 0, 2}); });
    write("elsewhere.msh", [](SimplexMesh& mesh) { move(mesh, {0, 0, -2}); });
    std::ofstream(meshes() + "/surface.msh")
        << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 9 0 0\n3 0 9 "
           "0\n4 0 0 -5\n$EndNodes\n$Elements\n3\n1 2 2 0 1 1 2 3\n2 2 2 0 1 1 2 "
           "4\n3 2 2 0 1 2 3 4\n$EndElements\n";
    std::ofstream(meshes() + "/text.msh") << "not a mesh\n";
  });
}

/// What stirsph does with a scene before its first step; the message of the error, empty when there is none.
std::string complaint(std::string text) {
  for (std::size_t at; (at = text.find("MESHES")) != std::string::npos;) text.replace(at, 6, meshes());
  std::string message;
  try {
    Simulation simulation(Comm(), read_scene_text(text, folder));
    check_field_names(simulation);
    simulation.start();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::Input) << error.what();
    message = error.what();
  }
  EXPECT_EQ(Comm().broadcast(message), message) << "all ranks say the same";
  return message;
}

struct Replacement {
  std::string old_piece, new_piece;
};

std::string with(const std::vector<Replacement>& replacements) {
  std::string text = good;
  for (const auto& [old_piece, new_piece] : replacements) {
    const std::size_t at = text.find(old_piece);
    EXPECT_NE(at, std::string::npos) << old_piece;
    if (at != std::string::npos) text.replace(at, old_piece.size(), new_piece);
  }
  return text;
}

struct BadInput {
  const char* what;
  std::vector<Replacement> replacements;
  std::vector<std::string> parts;  ///< of the message
};

const std::string mesh_line = "mesh = { file = \"MESHES/die.msh\", scale = 1e-3, body = \"die\" }";
const std::string bottom = "group = \"bottom\"\ntemperature = \"300 K\"";
const std::string box_shape =
    "shape = { type = \"box\", low = [\"-2 mm\", \"-2 mm\", \"-5 mm\"], high = [\"8 mm\", \"6 mm\", \"0 mm\"] }";
const std::string half_space =
    "shape = { type = \"half_space\", point = [\"0 mm\", \"0 mm\", \"0 mm\"], normal = [0, 0, 1] }";
const std::string probe_place = "position = [\"3 mm\", \"2 mm\", \"-2 mm\"]";

std::string other_file(const std::string& name) { return "mesh = { file = \"MESHES/" + name + "\", scale = 1e-3 }"; }

const std::vector<BadInput> bad_meshes{
    {"inverted element",
     {{mesh_line, other_file("inverted.msh")}},
     {"rigid \"die\" heat", "inverted.msh", "element ", "nodes ", "inverted", "allowed from 0.02", "Mesh it again"}},
    {"needle element",
     {{mesh_line, other_file("needle.msh")}},
     {"rigid \"die\" heat", "needle.msh", "element ", "needle or sliver", "allowed from 0.02", "Mesh it again"}},
    {"parts with nodes of their own",
     {{mesh_line, other_file("double.msh")}},
     {"double.msh: nodes ", "are both at", "no heat would flow", "common nodes"}},
    {"surface without a solid", {{mesh_line, other_file("surface.msh")}}, {"surface.msh", "no tetrahedra", "gmsh -3"}},
    {"hole where the billet touches",
     {{mesh_line, other_file("hole.msh")}},
     {"rigid \"die\"", "touches a particle at (", "hole.msh (of element ", "mm away", "scale or cut"}},
    {"millimetres read as metres",
     {{"scale = 1e-3, ", ""}},
     {"die.msh: the mesh is 10 m long, the shape of the body 0.01 m", "between 1/20 and 20", "scale = 1e-3"}},
    {"metres read as micrometres", {{"scale = 1e-3", "scale = 1e-6"}}, {"mesh is only 1e-05 m", "scale = 1e-3"}},
    {"scale without sense", {{"scale = 1e-3", "scale = 0"}}, {"rigid[0].heat.mesh.scale = 0", "> 0"}},
    {"mesh in the billet",
     {{mesh_line, other_file("overlapping.msh")}},
     {"rigid \"die\": particle ", "inside element ", "overlapping.msh", "overlaps a deformable body", "scale"}},
    {"mesh that does not follow the shape",
     {{mesh_line, other_file("elsewhere.msh")}},
     {"rigid \"die\": the shape touches a particle at (", "elsewhere.msh", "2 mm away", "not the same body"}},
    {"shape in the billet",
     {{"\"0 mm\"] }\n[rigid.heat]", "\"1 mm\"] }\n[rigid.heat]"}},
     {"rigid \"die\": it overlaps", "particle ", "0.5 mm deep", "allowed are 0.1 mm", "Move or shrink"}},
    {"no such file",
     {{"die.msh", "dye.msh"}},
     {"scene:", "rigid[0].heat.mesh.file", "dye.msh", "no such file", "relative"}},
    {"file of something else", {{mesh_line, other_file("text.msh")}}, {"text.msh", "not a mesh file", "$MeshFormat"}},
    {"unknown physical volume",
     {{"body = \"die\"", "body = \"dye\""}},
     {"rigid \"die\" heat", "die.msh: no body called \"dye\"", "The file's bodies: die"}},
    {"file and sizes",
     {{"scale = 1e-3", "near = \"1 mm\""}},
     {"rigid[0].heat.mesh.file", "either a file or near and far"}},
    {"file and cut",
     {{"scale = 1e-3", "cut_low = [\"0 m\", \"0 m\", \"0 m\"]"}},
     {"rigid[0].heat.mesh.file", "leave cut_low and cut_high out"}},
    {"no sizes", {{mesh_line, "mesh = { far = \"3 mm\" }"}}, {"scene:", "rigid[0].heat.mesh.near", "\"1 mm\"", "file"}},
    {"body without file",
     {{"file = \"MESHES/die.msh\", scale = 1e-3", "near = \"1 mm\""}},
     {"rigid[0].heat.mesh.body", "mesh file", "leave body out"}},
    {"far below near",
     {{mesh_line, "mesh = { near = \"2 mm\", far = \"1 mm\" }"}},
     {"rigid[0].heat.mesh.far", "not be shorter than near"}},
    {"micrometres for millimetres",
     {{mesh_line, "mesh = { near = \"2 um\", far = \"4 um\" }"}},
     {"rigid \"die\" heat", "edges of 0.002 to 0.004 mm", "elements. Allowed: 2e+07", "Enlarge near"}},
    {"no mesh", {{mesh_line, ""}}, {"rigid[0].heat.role = \"mesh\"", "near = ", "file = "}},
    {"endless shape",
     {{box_shape, half_space}, {mesh_line, "mesh = { near = \"2 mm\" }"}},
     {"rigid[0].heat.mesh.near", "endless along x", "cut_low and cut_high"}},
    {"shape endless along its axis",
     {{box_shape, "shape = { type = \"cylinder\", base = [\"-8 mm\", \"2 mm\", \"0 mm\"], radius = \"7 mm\" }"},
      {mesh_line, "mesh = { near = \"2 mm\" }"}},
     {"rigid[0].heat.mesh.near", "endless along z", "cut_low and cut_high"}},
    {"half a cut",
     {{box_shape, half_space}, {mesh_line, "mesh = { near = \"2 mm\", cut_low = [\"0 m\", \"0 m\", \"0 m\"] }"}},
     {"rigid[0].heat.mesh.cut_low", "go together"}},
    {"cut beside the shape",
     {{box_shape, half_space},
      {mesh_line,
       "mesh = { near = \"2 mm\", cut_low = [\"0 m\", \"0 m\", \"1 m\"], cut_high = [\"1 m\", \"1 m\", \"2 m\"] }"}},
     {"rigid \"die\" heat", "half space", "nothing of it lies within"}},
    {"cut smaller than the billet",
     {{box_shape, half_space},
      {mesh_line,
       "mesh = { near = \"1 mm\", cut_low = [\"-2 mm\", \"-2 mm\", \"-5 mm\"], cut_high = [\"3 mm\", \"6 mm\", \"1 "
       "mm\"] }"},
      {"group = \"bottom\"", "group = \"face 1\""},
      {probe_place, "position = [\"1 mm\", \"2 mm\", \"-2 mm\"]"}},
     {"rigid \"die\": the shape touches a particle", "half space", "scale or cut"}},
    {"no thermal material",
     {{"material = \"H13\"\n", ""}},
     {"rigid[0].heat.role = \"mesh\"", "material with a [thermal] table"}},
    {"hybrid without mesh",
     {{"role = \"fixed\", ", "role = \"fixed\", interface = \"hybrid\", "}},
     {"rigid[1].heat.interface = \"hybrid\"", "role = \"mesh\""}},
    {"mesh of a body at one temperature",
     {{"role = \"mesh\"\n", "role = \"fixed\"\n"}},
     {"rigid[0].heat.role = \"fixed\"", "mesh and surface need role = \"mesh\""}},
    {"no conductance", {{"conductance = \"1000 W/m2/K\"\n", ""}}, {"rigid[0].heat.conductance", "positive", "perfect"}},
    {"pressure without mechanics",
     {{"conductance = \"1000 W/m2/K\"\n", "pressure_conductance = \"1000 W/m2/K\"\n"}},
     {"rigid[0].heat.pressure_conductance", "no contact pressure"}},
    {"capacity of a mesh",
     {{"role = \"mesh\"\n", "role = \"mesh\"\nheat_capacity = \"3 J/K\"\n"}},
     {"rigid[0].heat.heat_capacity = \"3 J/K\"", "role = \"lumped\""}},
    {"surroundings of a mesh",
     {{"role = \"mesh\"\n", "role = \"mesh\"\nambient_conductance = \"3 W/K\"\n"}},
     {"rigid[0].heat.ambient_conductance = \"3 W/K\"", "[[rigid.heat.surface]]"}},
    {"unknown billet",
     {{"role = \"mesh\"\n", "role = \"mesh\"\nbodies = [\"bilet\"]\n"}},
     {"heat.bodies", "billet\"?"}},
    {"negative temperature of a mesh",
     {{"role = \"mesh\"\n", "role = \"mesh\"\ntemperature = \"100*x\"\n"}},
     {"rigid \"die\" heat", "the temperature is -0.", "at x, y, z = ", "Allowed: > 0 K"}},
    {"negative fixed temperature",
     {{"\"fixed\", temperature = \"300 K\"", "\"fixed\", temperature = \"-300 K\""}},
     {"rigid[1].heat.temperature = \"-300 K\"", "> 0 K"}},
    {"formula for a body of one temperature",
     {{"\"fixed\", temperature = \"300 K\"", "\"fixed\", temperature = \"300+x\""}},
     {"rigid[1].heat.temperature = \"300+x\"", "role = \"mesh\""}},

    {"unknown surface group",
     {{"\"bottom\"", "\"botom\""}},
     {"rigid \"die\" heat: surface[0]", "die.msh", "\"botom\"", "Known: bottom, side", "bottom\"?"}},
    {"unknown group of a flux",
     {{"\"1 mm\"] }\nflux", "\"1 mm\"] }\ngroup = \"left\"\nflux"}, {"region", "#"}},
     {"rigid \"die\" heat: surface[1]", "no surface group \"left\"", "Known: bottom, side"}},
    {"region without facets",
     {{bottom,
       "region = { type = \"sphere\", centre = [\"3 mm\", \"2 mm\", \"-2 mm\"], radius = \"1 mm\" }\ntemperature = "
       "\"300 K\""}},
     {"rigid \"die\" heat: surface[0]", "no facet of ", "sphere", "between (-2, -2, -5) and (8, 6, 0) mm",
      "move the region"}},
    {"flux through a region without facets",
     {{"high = [\"-1.9 mm\"", "high = [\"-2.9 mm\""}},
     {"rigid \"die\" heat: surface[1]", "no facet of ", "move the region"}},
    {"two fixed temperatures on one node",
     {{"[[rigid]]\nname = \"plate\"",
       "[[rigid.heat.surface]]\ngroup = \"side\"\ntemperature = \"400 K\"\n[[rigid]]\nname = \"plate\""}},
     {"rigid \"die\" heat", "die.msh: node ", "two surfaces of fixed temperature, 300 K and 400 K", "mm",
      "Allowed: one"}},
    {"surface with two conditions",
     {{bottom, bottom + "\nflux = \"1e5 W/m2\""}},
     {"rigid[0].heat.surface[0].temperature", "one of temperature", "flux"}},
    {"surface without condition", {{bottom, "group = \"bottom\""}}, {"rigid[0].heat.surface[0]", "one of temperature"}},
    {"surface without facets named",
     {{bottom, "temperature = \"300 K\""}},
     {"surface[0].region", "region or by a group"}},
    {"flux without a value",
     {{"flux = \"1e5 W/m2\"", "flux = \"1e5*q\""}},
     {"rigid[0].heat.surface[1].flux = \"1e5*q\"", "q"}},

    {"probe outside the mesh",
     {{probe_place, "position = [\"3 mm\", \"2 mm\", \"2 mm\"]"}},
     {"probe \"thermocouple\"", "(3, 2, 2) mm lies outside ", "die.msh", "2 mm from", "Give a place inside"}},
    {"probe in an insulated body",
     {{"heat = { role = \"fixed\", temperature = \"300 K\", conductance = \"1000 W/m2/K\" }\n", ""},
      {"rigid = \"die\"\nposition", "rigid = \"plate\"\nposition"}},
     {"probe[0].rigid = \"plate\"", "no part in the heat balance", "heat.role"}},
    {"source in an unknown body",
     {{"[\"billet\", \"die\"]", "[\"billet\", \"dye\"]"}},
     {"heat_source[0].on", "\"dye\"", "Known: billet, die", "die\"?"}},
    {"source in a body without mesh",
     {{"[\"billet\", \"die\"]", "[\"plate\"]"}},
     {"heat_source[0].on", "\"plate\" is no body this source can heat", "Known: billet, die"}},
    {"flux source on a mesh",
     {{"density = \"1e6 W/m3\"", "flux = \"1e6 W/m2\""}},
     {"heat_source[0].on", "\"die\" is no body this source can heat", "Known: billet."}},
    {"source of two kinds",
     {{"density = \"1e6 W/m3\"", "density = \"1e6 W/m3\"\nflux = \"1e6 W/m2\""}},
     {"heat_source[0].on", "one of density (W/m3) and flux (W/m2)"}},
    {"source without conduction",
     {{"mode = \"conduction\"", "mode = \"adiabatic\""},
      {"mechanics = false", ""},
      {"[[probe]]", "[[probe]]#"},
      {"rigid = \"die\"\n", ""}},
     {"heat_source", "heat.mode = \"conduction\""}},
    {"probe without conduction",
     {{"mode = \"conduction\"", "mode = \"adiabatic\""}, {"mechanics = false", ""}},
     {"probe[0].rigid = \"die\"", "heat.mode = \"conduction\""}},
    {"surroundings without conduction",
     {{"mode = \"conduction\"", "mode = \"adiabatic\"\nambient = { conductance = \"20 W/m2/K\" }"},
      {"mechanics = false", ""},
      {"rigid = \"die\"\n", ""},
      {"[[heat_source]]\non = [\"billet\", \"die\"]\ndensity = \"1e6 W/m3\"\n", ""}},
     {"heat.ambient", "heat.mode = \"conduction\""}},
};

TEST(BadMesh, TheSceneItselfWorks) {
  write_meshes();
  EXPECT_EQ(complaint(good), "");
}

TEST(BadMesh, IsRefusedWithPlaceElementAndRemedy) {
  write_meshes();
  for (const BadInput& bad : bad_meshes) {
    const std::string message = complaint(with(bad.replacements));
    EXPECT_NE(message, "") << bad.what;
    for (const std::string& part : bad.parts)
      EXPECT_NE(message.find(part), std::string::npos) << bad.what << ": \"" << part << "\" is not in\n  " << message;
    if (Comm().is_root()) std::printf("%s:\n  %s\n", bad.what, message.c_str());
  }
}

}  // namespace
}  // namespace stirsph
