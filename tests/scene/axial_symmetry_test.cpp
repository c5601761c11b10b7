/// Scenes that cannot be computed in the axisymmetric space: each is refused when it is read, with a message that names
/// the body, the value and the remedy; and those that can are not.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace stirsph {
namespace {

/// A scene that works; each case replaces one piece of it.
const std::string good = R"toml(
space = "axisymmetric"
body_force = { z = "-9.81 m/s2" }
[numerics]
spacing = "1 mm"
[time]
end = "10 us"
[[material]]
name = "AL"
file = "materials/aa2024_t351.toml"
[[body]]
name = "billet"
material = "AL"
shape = { type = "cylinder", radius = "8 mm", height = "10 mm" }
velocity = { x = "-10*x", z = "1 m/s" }
rotation = { rate = "100 rpm" }
[[rigid]]
name = "tool"
shape = { type = "frustum", base = ["0 mm", "0 mm", "10 mm"], base_radius = "5 mm", top_radius = "7 mm", height = "20 mm" }
motion = { type = "force", direction = [0, 0, -1], preload = "1 N", target = "2 N" }
rotation = { rate = "1500 rpm" }
[[rigid]]
name = "plate"
shape = { type = "half_space", point = ["3 mm", "0 mm", "0 mm"], normal = [0, 0, 1] }
motion = { type = "velocity", z = "0 m/s" }
[[rigid]]
name = "die"
[rigid.shape]
type = "difference"
shape = { type = "cylinder", base = ["0 mm", "0 mm", "-3 mm"], radius = "20 mm", height = "40 mm" }
remove = [{ type = "cylinder", base = ["0 mm", "0 mm", "0 mm"], radius = "8 mm", height = "90 mm" }]
[[contact]]
rigid = "tool"
[[set]]
name = "end"
region = { type = "box", low = ["-9 mm", "-9 mm", "0 mm"], high = ["9 mm", "9 mm", "2 mm"] }
[[grip]]
name = "hold"
set = "end"
velocity = { x = "0 m/s" }
)toml";

std::string complaint(const std::string& text) {
  try {
    read_scene_text(text, std::string(STIRSPH_SOURCE_DIR) + "/inputs");
  } catch (const InputError& error) {
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

TEST(AxialSymmetry, RoundScenesAreTaken) {
  EXPECT_EQ(complaint(good), "");
  // Round, though one of its parts is not.
  EXPECT_EQ(complaint(with(R"(shape = { type = "cylinder", radius = "8 mm", height = "10 mm" })",
                           R"(shape = { type = "intersection", shapes = [{ type = "cylinder", radius = "8 mm" },
    { type = "box", low = ["-20 mm", "-20 mm", "0 mm"], high = ["20 mm", "20 mm", "10 mm"] }] })")),
            "");
  EXPECT_EQ(complaint(with("rate = \"1500 rpm\"", "axis = [0, 0, -1], rate = \"1500 rpm\"")), "");
}

TEST(AxialSymmetry, OthersAreRefusedWithPlaceValueAndRemedy) {
  struct Case {
    const char *old_piece, *new_piece;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases{
      {R"(type = "cylinder", radius = "8 mm", height = "10 mm")",
       R"(type = "box", low = ["-8 mm", "-8 mm", "0 mm"], high = ["8 mm", "8 mm", "10 mm"])",
       {"body \"billet\".shape", "is not round about the z axis", "degrees", "cartesian3"}},
      {R"(base = ["0 mm", "0 mm", "10 mm"])", R"(base = ["0.1 mm", "0 mm", "10 mm"])", {"rigid \"tool\".shape"}},
      {"normal = [0, 0, 1]", "normal = [0, 0.1, 1]", {"rigid \"plate\".shape"}},
      {R"(base = ["0 mm", "0 mm", "0 mm"], radius = "8 mm", height = "90 mm")",
       R"(base = ["0 mm", "12 mm", "0 mm"], radius = "2 mm", height = "90 mm")",
       {"rigid \"die\".shape"}},
      {"rotation = { rate = \"100 rpm\" }",
       "rotation = { axis = [1, 0, 0], rate = \"100 rpm\" }",
       {"body \"billet\".rotation.axis = [1, 0, 0]", "z axis", "Allowed: [0, 0, 1]"}},
      {"rotation = { rate = \"1500 rpm\" }",
       "rotation = { centre = [\"0 mm\", \"2 mm\", \"0 mm\"], rate = \"1500 rpm\" }",
       {"rigid \"tool\".rotation.centre lies 2 mm beside the z axis", "Allowed: x = y = 0"}},
      {"direction = [0, 0, -1]", "direction = [0, 1, -1]", {"rigid \"tool\".motion.direction", "along z only"}},
      {"type = \"velocity\", z = \"0 m/s\"",
       "type = \"velocity\", y = \"0.1*t\"",
       {"rigid \"plate\".motion.y = \"0.1*t\"", "across the z axis"}},
      {"x = \"-10*x\", z", "x = \"-10 m/s\", z", {"body \"billet\".velocity.x = \"-10", "formula of x, y, z"}},
      {"velocity = { x = \"0 m/s\" }", "velocity = { y = \"1 m/s\" }", {"grip \"hold\".velocity.y"}},
      {"set = \"end\"\n",
       "set = \"end\"\nrotation = { axis = [0, 1, 0], rate = \"1 rpm\" }\n",
       {"grip \"hold\".rotation"}},
      {"z = \"-9.81 m/s2\"", "x = \"sin(t)\"", {"body_force.x = \"sin(t)\"", "Allowed: 0, and any value of z"}},
  };
  for (const Case& wrong : cases) {
    const std::string message = complaint(with(wrong.old_piece, wrong.new_piece));
    EXPECT_NE(message, "") << wrong.new_piece;
    for (const std::string& part : wrong.parts)
      EXPECT_NE(message.find(part), std::string::npos) << "\"" << part << "\" is not in\n  " << message;
    std::printf("%s\n", message.c_str());
    // The same scene in three dimensions is nobody's mistake.
    std::string solid = with(wrong.old_piece, wrong.new_piece);
    solid.replace(solid.find("axisymmetric"), 12, "cartesian3");
    EXPECT_EQ(complaint(solid), "");
  }
}

TEST(AxialSymmetry, CutsNeedThreeCoordinates) {
  const std::string meshed =
      with("shape = { type = \"half_space\", point = [\"3 mm\", \"0 mm\", \"0 mm\"], normal = [0, 0, 1] }",
           "material = \"AL\"\nshape = { type = \"half_space\", point = [\"3 mm\", \"0 mm\", \"0 mm\"], normal = [0, "
           "0, 1] }\n"
           "heat = { role = \"mesh\", conductance = \"1 W/m2/K\", mesh = { near = \"1 mm\" CUT } }");
  const auto cut = [&](const std::string& text) {
    std::string scene = meshed;
    return complaint(scene.replace(scene.find("CUT"), 3, text));
  };
  EXPECT_NE(cut("").find("endless along x"), std::string::npos);
  EXPECT_NE(cut(", cut_low = [\"0 mm\", \"-4 mm\"], cut_high = [\"20 mm\", \"0 mm\"]").find("three coordinates"),
            std::string::npos);
  EXPECT_EQ(cut(", cut_low = [\"-20 mm\", \"-20 mm\", \"-4 mm\"], cut_high = [\"20 mm\", \"20 mm\", \"0 mm\"]"), "");
}

}  // namespace
}  // namespace stirsph
