/// Wrong scenes: each is refused before the first step, with a message that names the place, the value and the remedy.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "driver/probes.hpp"
#include "driver/simulation.hpp"
#include "scene/scene.hpp"

namespace stirsph {
namespace {

/// A scene that works; each case replaces one piece of it.
const std::string good = R"toml(
[numerics]
spacing = "1 mm"
[time]
end = "10 us"
[domain]
periodic = []
[[material]]
name = "AL"
file = "materials/aa2024_t351.toml"
[[body]]
name = "billet"
material = "AL"
shape = { type = "box", low = ["0 mm", "0 mm", "0 mm"], high = ["6 mm", "4 mm", "4 mm"] }
temperature = "600 K"
[[body]]
name = "second"
material = "AL"
shape = { type = "box", low = ["20 mm", "0 mm", "0 mm"], high = ["24 mm", "4 mm", "4 mm"] }
[[rigid]]
name = "tool"
shape = { type = "cylinder", base = ["3 mm", "2 mm", "4 mm"], radius = "2 mm", height = "5 mm" }
motion = { type = "velocity", z = "-1 m/s" }
heat = { role = "lumped", heat_capacity = "3 J/K", conductance = "500 W/m2/K" }
[[contact]]
rigid = "tool"
friction = 0.3
[[set]]
name = "end"
region = { type = "box", low = ["-1 mm", "-1 mm", "-1 mm"], high = ["1 mm", "9 mm", "9 mm"] }
[[grip]]
name = "hold"
set = "end"
velocity = { x = "0 m/s" }
[[probe]]
name = "hot"
kind = "maximum"
field = "temperature"
[heat]
mode = "adiabatic"
)toml";

const std::string folder = std::string(STIRSPH_SOURCE_DIR) + "/inputs";

/// What stirsph does with a scene before its first step; the message of the error, empty when there is none.
std::string complaint(const std::string& text) {
  try {
    Simulation simulation(Comm(), read_scene_text(text, folder));
    check_field_names(simulation);
    simulation.start();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::Input) << error.what();
    return error.what();
  }
  return "";
}

std::string with(const std::string& old_piece, const std::string& new_piece) {
  std::string text = good;
  const std::size_t at = text.find(old_piece);
  EXPECT_NE(at, std::string::npos) << old_piece;
  return text.replace(at, old_piece.size(), new_piece);
}

struct BadInput {
  const char* what;
  const char* old_piece;
  const char* new_piece;
  std::vector<std::string> parts;  ///< of the message
};

const std::vector<BadInput> bad_inputs{
    {"wrong unit",
     "spacing = \"1 mm\"",
     "spacing = \"1 kg\"",
     {"scene:3 numerics.spacing = \"1 kg\"", "initial particle spacing", "Allowed: > 0 m"}},
    {"bare number", "end = \"10 us\"", "end = 1e-5", {"scene:5 time.end = 1e-5", "unit", "\"1e-05 s\""}},
    {"unknown key", "friction = 0.3", "fricton = 0.3", {"contact[0].fricton", "unknown key", "Known: ", "friction\"?"}},
    {"missing key",
     "end = \"10 us\"",
     "",
     {"time.end: missing", "process time at which the run ends", "end = \"1 s\""}},
    {"missing material file",
     "aa2024_t351.toml",
     "aa2024_t352.toml",
     {"material[0].file = \"materials/aa2024_t352.toml\"", "no such file", "relative"}},
    {"unknown material", "material = \"AL\"", "material = \"steel\"", {"body[0].material = \"steel\"", "Known: AL"}},
    {"out of range",
     "temperature = \"600 K\"",
     "temperature = \"600 K\"\njitter = 0.7",
     {"body[0].jitter = 0.7", "<= 0.45"}},
    {"negative temperature", "\"600 K\"", "\"-600 K\"", {"body", "temperature", "-600", "0 K"}},
    {"formula without a value",
     "temperature = \"600 K\"",
     "velocity = { y = \"log(x-2e-3)\" }",
     {"body \"billet\"", "log(x-2e-3)", "nan at x = ", "must have a value"}},
    {"unknown choice",
     "kind = \"maximum\"",
     "kind = \"maximal\"",
     {"probe[0].kind = \"maximal\"", "Did you mean \"maximum\"?", "extruded_length"}},
    {"tool inside the billet",
     "\"2 mm\", \"4 mm\"]",
     "\"2 mm\", \"3 mm\"]",
     {"rigid \"tool\"", "overlaps", "particle", "mm deep, allowed are", "move or shrink"}},
    {"bodies on each other",
     "[\"20 mm\", \"0 mm\", \"0 mm\"], high = [\"24 mm\"",
     "[\"4 mm\", \"0 mm\", \"0 mm\"], high = [\"8 mm\"",
     {"of billet", "of second", "sit on each other", "difference"}},
    {"duplicate name", "name = \"second\"", "name = \"billet\"", {"body[1].name = \"billet\"", "already taken"}},
    {"viscosity on a light swirl",
     "spacing = \"1 mm\"",
     "spacing = \"1 mm\"\ninertia = \"no_swirl\"\nswirl_density_ratio = 0.1",
     {"scene:5 numerics.swirl_density_ratio = 0.1", "viscosity_velocity = \"no_swirl\"", "or the ratio 1"}},
    {"bound of a correction that is off",
     "spacing = \"1 mm\"",
     "spacing = \"1 mm\"\nlargest_correction = 50",
     {"scene:4 numerics.largest_correction = 50", "no correction to bound", "Give gradient_correction"}},
    {"force without contact",
     "[[contact]]\n",
     "[[rigid]]\nname = \"press\"\n"
     "shape = { type = \"half_space\", point = [\"0 m\", \"0 m\", \"9 mm\"], normal = [0.0, 0.0, -1.0] }\n"
     "motion = { type = \"force\", preload = \"1 N\", target = \"2 N\" }\n[[contact]]\n",
     {"rigid \"press\"", "force control needs a [[contact]]"}},
    {"misspelt limit of a force programme",
     "motion = { type = \"velocity\", z = \"-1 m/s\" }",
     "motion = { type = \"force\", preload = \"1 N\", target = \"2 N\", velocty_limit = \"1 mm/s\" }",
     {"rigid[0].motion.velocty_limit", "unknown key", "velocity_limit\"?"}},
    {"retreat without a beginning",
     "motion = { type = \"velocity\", z = \"-1 m/s\" }",
     "retreat = { speed = \"1 mm/s\", distance = \"5 mm\" }",
     {"rigid[0].retreat", "give one of at", "dwell"}},
    {"dwell without an end",
     "motion = { type = \"velocity\", z = \"-1 m/s\" }",
     "motion = { type = \"velocity\", z = \"-1 m/s\" }\n"
     "retreat = { dwell = \"2 s\", speed = \"1 mm/s\", distance = \"5 mm\" }",
     {"rigid[0].retreat.dwell = \"2 s\"", "no end", "at = \"40 s\""}},
    {"tool without room for its fillet",
     "type = \"cylinder\", base = [\"3 mm\", \"2 mm\", \"4 mm\"], radius = \"2 mm\", height = \"5 mm\" }",
     "type = \"tool\", base = [\"3 mm\", \"2 mm\", \"4 mm\"], radius = \"2 mm\", height = \"5 mm\", "
     "edge_fillet = \"3 mm\" }",
     {"rigid[0].shape.edge_fillet = \"3 mm\"", "up to 2 mm"}},
    {"profile that crosses itself",
     "type = \"cylinder\", base = [\"3 mm\", \"2 mm\", \"4 mm\"], radius = \"2 mm\", height = \"5 mm\" }",
     "type = \"profile\", points = [{ r = \"0 mm\", z = \"9 mm\" }, { r = \"2 mm\", z = \"5 mm\" }, "
     "{ r = \"2 mm\", z = \"9 mm\" }, { r = \"0 mm\", z = \"5 mm\" }] }",
     {"rigid[0].shape.points", "vertex 0 (r = 0 mm, z = 9 mm)", "vertex 2", "must not cross itself"}},
    {"periodic without box", "periodic = []", "periodic = [\"x\"]", {"domain.periodic", "domain.low and domain.high"}},
    {"lumped node without capacity",
     "heat_capacity = \"3 J/K\", ",
     "",
     {"rigid[0].heat.heat_capacity", "positive heat capacity", "500 J/K"}},
    {"empty body", "spacing = \"1 mm\"", "spacing = \"20 mm\"", {"body \"billet\"", "spacing"}},
    {"probe of an unknown field",
     "field = \"temperature\"",
     "field = \"temprature\"",
     {"probe \"hot\"", "no field \"temprature\"", "Known: ", "Did you mean \"temperature\"?"}},
    {"snapshot of an unknown field",
     "[heat]",
     "[output]\nfields = [\"stres\"]\n[heat]",
     {"output.fields", "no field \"stres\"", "Did you mean \"stress\"?"}},
    {"microstructure without data",
     "[heat]",
     "[microstructure]\nwindow = \"1 ms\"\n[[material]]\nname = \"B\"\nfile = \"materials/aa5754.toml\"\n"
     "[[body]]\nname = \"third\"\nmaterial = \"B\"\n"
     "shape = { type = \"box\", low = [\"40 mm\", \"0 mm\", \"0 mm\"], high = [\"44 mm\", \"4 mm\", \"4 mm\"] "
     "}\n[heat]",
     {"microstructure", "material \"B\" of body \"third\"", "no [microstructure] table", "aa2024_t351.toml"}},
    {"window of no length",
     "[heat]",
     "[microstructure]\nwindow = \"0 s\"\n[heat]",
     {"microstructure.window = \"0 s\"", "Allowed: > 0 s"}},
    {"hardness without microstructure",
     "field = \"temperature\"",
     "field = \"hardness\"",
     {"probe \"hot\"", "no field \"hardness\"", "Known: "}},
    {"mixing of one material",
     "kind = \"maximum\"",
     "kind = \"mixing\"",
     {"probe[0].by", "all of one material", "by = \"body\""}},
    {"angle of a ring",
     "[numerics]",
     "space = \"axisymmetric\"\n[[probe]]\nname = \"a\"\nkind = \"angular_spread\"\n[numerics]",
     {"probe[0].kind", "ring", "no angle"}},
    {"tracer of an unknown set",
     "[heat]",
     "[[tracer]]\nname = \"t\"\nset = \"ends\"\ninterval = \"1 us\"\n[heat]",
     {"tracer[0].set = \"ends\"", "Known: end"}},
    {"tracer of a vector",
     "[heat]",
     "[[tracer]]\nname = \"t\"\nset = \"end\"\ninterval = \"1 us\"\nfields = [\"velocity\"]\n[heat]",
     {"tracer \"t\"", "\"velocity\" has 3 components", "one component"}},
    {"tracer with a path for a name",
     "[heat]",
     "[[tracer]]\nname = \"a/b\"\nset = \"end\"\ninterval = \"1 us\"\n[heat]",
     {"tracer[0].name = \"a/b\"", "file name"}},
    {"snapshot of a coordinate",
     "[heat]",
     "[output]\nfields = [\"radius\"]\n[heat]",
     {"output.fields", "no field \"radius\""}},
    {"empty set", "[\"1 mm\", \"9 mm\", \"9 mm\"]", "[\"0.2 mm\", \"9 mm\", \"9 mm\"]", {"set \"end\"", "no particle"}},
    {"not TOML", "spacing = \"1 mm\"", "spacing = 1 mm", {"scene", "3"}},
};

TEST(BadInput, ForceControlNeedsMechanics) {
  const std::string force = "type = \"force\", preload = \"1 N\", target = \"2 N\"";
  std::string text = "mechanics = false\n" + with("type = \"velocity\", z = \"-1 m/s\"", force);
  const std::string end = "end = \"10 us\"";
  text.replace(text.find(end), end.size(), end + "\nstep = \"1 us\"");
  const std::string message = complaint(text);
  EXPECT_NE(message.find("rigid[0].motion.type = \"force\""), std::string::npos) << message;
  EXPECT_NE(message.find("without mechanics there is no force"), std::string::npos) << message;
}

TEST(BadInput, ATableThatGoesBackInTimeIsRefusedWithItsLine) {
  const std::string table = std::string(STIRSPH_BINARY_DIR) + "/backwards.csv";
  std::ofstream(table) << "# measured\ntime [s], displacement [mm]\n0, 0\n2, 1\n1.5, 2\n";
  const std::string path = "motion = { type = \"displacement\", table = \"" + table + "\" }";
  const std::string message = complaint(with("motion = { type = \"velocity\", z = \"-1 m/s\" }", path));
  EXPECT_NE(message.find("backwards.csv:5 time = 1.5 s"), std::string::npos) << message;
  EXPECT_NE(message.find("Times must increase"), std::string::npos) << message;
}

TEST(BadInput, TheSceneItselfWorks) { EXPECT_EQ(complaint(good), ""); }

/// The corner of a box is what a Courant number of 0.5 bears; a bound that lets chips be stiffer makes the steps
/// smaller.
TEST(DefaultStep, FollowsTheLargestCorrection) {
  const auto cfl = [](const std::string& numerics) {
    std::string text = good;
    text.insert(text.find("spacing"), "gradient_correction = \"full\"\n" + numerics);
    return read_scene_text(text, folder).time.cfl;
  };
  EXPECT_EQ(cfl(""), 0.5);
  EXPECT_EQ(cfl("largest_correction = 3\n"), 0.5);
  EXPECT_NEAR(cfl("largest_correction = 14\n"), 0.44, 0.005);  // of limits that were measured as 0.50 and 0.43
  EXPECT_NEAR(cfl("largest_correction = 50\n"), 0.34, 0.005);
}

TEST(BadInput, IsRefusedWithPlaceValueAndRemedy) {
  for (const BadInput& bad : bad_inputs) {
    const std::string message = complaint(with(bad.old_piece, bad.new_piece));
    EXPECT_NE(message, "") << bad.what;
    for (const std::string& part : bad.parts)
      EXPECT_NE(message.find(part), std::string::npos) << bad.what << ": \"" << part << "\" is not in\n  " << message;
    std::printf("%s:\n  %s\n", bad.what, message.c_str());
  }
}

}  // namespace
}  // namespace stirsph
