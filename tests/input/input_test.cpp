/// Input files: units, defaults, messages, overrides, the effective input and the manual.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "base/error.hpp"
#include "input/parameters.hpp"
#include "input/units.hpp"

namespace stirsph::input {
namespace {

const std::map<std::string, Schema>& solids() {
  static const std::map<std::string, Schema> known = [] {
    std::map<std::string, Schema> map;
    map["ball"] = Schema("A ball.");
    map["ball"].real("radius", "radius of the ball").unit("m").positive();
    map["union"] = Schema("Several solids.");
    map["union"].variants("parts", "type", solids, "the solids joined").count(1, 9);
    return map;
  }();
  return known;
}

Schema scene() {
  Schema schema("A scene.");
  schema.text("title", "name of the run").by_default("a \"run\"");
  Schema& time = schema.table("time", "Time stepping.");
  time.real("end", "end time").unit("s").positive().by_default("2 s");
  time.integer("report", "steps between log lines").range(1, 1000000).by_default(100);
  time.boolean("adaptive", "step from the stability limit").by_default(true);
  Schema& tool = schema.table("tool", "The rotating tool.", true);
  tool.real("speed", "rotational speed").unit("rad/s");
  tool.real("force", "axial force").unit("N").not_negative().optional();
  tool.reals("axis", "direction of the axis").count(3, 3).by_default("[0, 0, 1]");
  tool.reals("position", "start of the axis").unit("m").by_default("[\"0 mm\", \"1 mm\"]");
  tool.expression("feed", {"t"}, "feed rate").unit("m/s").by_default("0 m/s");
  Schema& body = schema.tables("body", "A deformable body.");
  body.text("name", "name of the body");
  body.real("temperature", "start temperature").unit("K").positive().by_default(293.15);
  body.real("scaling", "mass scaling").range(1, 1e9).by_default(1.0);
  body.choice("kernel", {"cubic", "wendland_c2", "wendland_c4"}, "smoothing kernel").by_default("cubic");
  body.texts("output", "fields written").by_default("[\"stress\", \"temperature\"]");
  body.variant("shape", "type", solids, "shape of the body");
  return schema;
}

const std::string good = R"toml(title = "seed case"
[time]
end = "5 s"
[tool]
speed = "1500 rpm"
force = "12 kN"
feed = "0.1*sin(2*pi*t)"
[[body]]
name = "billet"
temperature = "25 degC"
scaling = 1e6
[body.shape]
type = "ball"
radius = "0.4 mm"
[[body]]
name = "pair"
kernel = "wendland_c2"
shape.type = "union"
[[body.shape.parts]]
type = "ball"
radius = "1 mm"
[[body.shape.parts]]
type = "union"
parts = [{ type = "ball", radius = "2 mm" }]
)toml";

Parameters read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_text(text, "scene.toml", scene(), ".", overrides);
}

std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read(text, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the text has no " + from);
  return text.replace(at, from.size(), to);
}

TEST(Units, ConvertToSi) {
  EXPECT_NEAR(to_si("1500 rpm", "rad/s"), 50 * std::numbers::pi, 1e-10);
  EXPECT_EQ(to_si("12 kN", "N"), 12000);
  EXPECT_EQ(to_si("0.4 mm", "m"), 0.0004);
  EXPECT_EQ(to_si("12.5mm", "m"), 0.0125);
  EXPECT_EQ(to_si("147 W/m2/K", "W/m2/K"), 147);
  EXPECT_EQ(to_si("147 W/m2/degC", "W/m2/K"), 147);
  EXPECT_DOUBLE_EQ(to_si("25 degC", "K"), 298.15);
  EXPECT_DOUBLE_EQ(to_si("25 °C", "K"), 298.15);
  EXPECT_DOUBLE_EQ(to_si("25 degC", "K", true), 25);
  EXPECT_DOUBLE_EQ(to_si("5 degC/s", "K/s"), 5);
  EXPECT_EQ(to_si("0.5 kN/s", "N/s"), 500);
  EXPECT_DOUBLE_EQ(to_si("95 percent", "1"), 0.95);
  EXPECT_DOUBLE_EQ(to_si("95 %", "1"), 0.95);
  EXPECT_EQ(to_si("0.25", "1"), 0.25);
  EXPECT_EQ(to_si("1 1/s", "1/s"), 1);
  EXPECT_EQ(to_si("72.4 GPa", "Pa"), 72.4e9);
  EXPECT_EQ(to_si("2785 kg/m3", "kg/m3"), 2785);
  EXPECT_EQ(to_si("60 mm/min", "m/s"), 0.001);
  EXPECT_NEAR(to_si("90 deg", "rad"), std::numbers::pi / 2, 1e-14);
  EXPECT_NEAR(to_si("60 rev/min", "rad/s"), 2 * std::numbers::pi, 1e-13);
  EXPECT_EQ(to_si("-1e-3 m", "m"), -0.001);
}

TEST(Units, RefuseWhatIsAmbiguous) {
  EXPECT_THROW(to_si("25 Hz", "rad/s"), UnitError);  // would be 25 rad/s
  EXPECT_THROW(to_si("90 deg", "1"), UnitError);
  EXPECT_THROW(to_si("1500", "rad/s"), UnitError);
  EXPECT_THROW(to_si("12 kN", "Pa"), UnitError);
  EXPECT_THROW(to_si("12 kNN", "N"), UnitError);
  EXPECT_THROW(to_si("fast", "m/s"), UnitError);
  EXPECT_THROW(to_si("nan m", "m"), UnitError);
}

TEST(Input, ReadsValuesInSi) {
  const Parameters p = read(good);
  EXPECT_EQ(p.text("title"), "seed case");
  EXPECT_EQ(p.table("time").real("end"), 5);
  EXPECT_EQ(p.table("time").integer("report"), 100);
  EXPECT_TRUE(p.table("time").boolean("adaptive"));
  const Parameters tool = p.table("tool");
  EXPECT_NEAR(tool.real("speed"), 50 * std::numbers::pi, 1e-10);
  EXPECT_EQ(tool.vector("axis"), (Vec3{0, 0, 1}));
  EXPECT_EQ(tool.vector("position"), (Vec3{0, 0.001, 0}));
  EXPECT_NEAR(tool.expression("feed")({0.25}), 0.1, 1e-15);
  const auto bodies = p.tables("body");
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_DOUBLE_EQ(bodies[0].real("temperature"), 298.15);
  EXPECT_EQ(bodies[0].real("scaling"), 1e6);
  EXPECT_EQ(bodies[0].table("shape").text("type"), "ball");
  EXPECT_EQ(bodies[1].real("temperature"), 293.15);
  EXPECT_EQ(bodies[1].texts("output"), (std::vector<std::string>{"stress", "temperature"}));
  const auto parts = bodies[1].table("shape").tables("parts");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[1].tables("parts").at(0).real("radius"), 0.002);
  EXPECT_EQ(bodies[0].where("name"), "scene.toml:9");
}

TEST(Input, MissingTables) {
  const Parameters p = read("");
  EXPECT_FALSE(p.has("tool"));
  EXPECT_TRUE(p.has("time"));
  EXPECT_EQ(p.table("time").real("end"), 2);
  EXPECT_TRUE(p.tables("body").empty());
}

TEST(Input, MisuseIsAnInternalError) {
  const Parameters p = read(good);
  for (const auto& wrong : {+[](const Parameters& q) { q.real("title"); }, +[](const Parameters& q) { q.has("tilte"); },
                            +[](const Parameters& q) { q.table("time").text("stop"); }}) {
    try {
      wrong(p);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::Internal) << error.what();
    }
  }
}

TEST(InputErrors, SayWhereWhatAndWhatToDo) {
  EXPECT_EQ(
      error_of(replaced(good, "force =", "froce =")),
      "scene.toml:6 tool.froce = \"12 kN\": unknown key in [tool]. Known: speed, force, axis, position, feed. Did "
      "you mean \"force\"?");
  EXPECT_EQ(error_of(replaced(good, "wendland_c2", "wenland_c2")),
            "scene.toml:17 body[1].kernel = \"wenland_c2\": no such choice (smoothing kernel). Allowed: cubic, "
            "wendland_c2, wendland_c4. Did you mean \"wendland_c2\"?");
  EXPECT_EQ(
      error_of(replaced(good, "radius = \"1 mm\"", "radius = \"-1 mm\"")),
      "scene.toml:21 body[1].shape.parts[0].radius = \"-1 mm\": out of range (-0.001 m). Allowed: > 0 m. Meaning: "
      "radius of the ball");
  EXPECT_EQ(error_of(replaced(good, "scaling = 1e6", "scaling = 0")),
            "scene.toml:11 body[0].scaling = 0: out of range. Allowed: >= 1 and <= 1e+09. Meaning: mass scaling");
  EXPECT_EQ(
      error_of(replaced(good, "\"12 kN\"", "12000")),
      "scene.toml:6 tool.force = 12000: a number without a unit. Expected: a quantity in N (axial force). If SI is "
      "meant, write force = \"12000 N\"");
  EXPECT_EQ(error_of(replaced(good, "12 kN", "12")),
            "scene.toml:6 tool.force = \"12\": has no unit. Expected: a quantity in N. If SI is meant, write \"12 N\" "
            "(axial force). Allowed: >= 0 N.");
  EXPECT_EQ(error_of(replaced(good, "12 kN", "12 MPa")),
            "scene.toml:6 tool.force = \"12 MPa\": the unit \"MPa\" does not convert to N. Expected: a quantity in N "
            "(axial force). Allowed: >= 0 N.");
  EXPECT_EQ(
      error_of(replaced(good, "1500 rpm", "25 Hz")),
      "scene.toml:5 tool.speed = \"25 Hz\": the unit \"Hz\" does not convert to rad/s (say the angle: rad/s, rpm, "
      "deg). Expected: a quantity in rad/s (rotational speed).");
  EXPECT_EQ(
      error_of(replaced(good, "speed = \"1500 rpm\"\n", "")),
      "scene.toml:4 tool.speed: missing. Meaning: rotational speed [rad/s]. Add for instance speed = \"1 rad/s\"");
  EXPECT_EQ(error_of(replaced(good, "name = \"pair\"\n", "")),
            "scene.toml:15 body[1].name: missing. Meaning: name of the body. Add for instance name = \"text\"");
  EXPECT_EQ(
      error_of(replaced(good, "\"12 kN\"", "{ value = 12 }")),
      "scene.toml:6 tool.force = {...}: a table where a quantity in N is expected (axial force). Allowed: >= 0 N. "
      "Write for instance force = \"1 N\"");
  EXPECT_EQ(error_of("[time]\nreport = 2.5\n"),
            "scene.toml:2 time.report = 2.5: a number where an integer is expected (steps between log lines). Allowed: "
            ">= 1 and <= 1e+06. Write for instance report = 1");
  EXPECT_EQ(error_of(replaced(good, "type = \"ball\"\nradius = \"0.4 mm\"", "radius = \"0.4 mm\"")),
            "scene.toml:12 body[0].shape.type: missing (shape of the body). Allowed: ball, union. Add type = \"ball\"");
  EXPECT_EQ(error_of(replaced(good, "type = \"ball\"", "type = \"bal\"")),
            "scene.toml:13 body[0].shape.type = \"bal\": no such choice (shape of the body). Allowed: ball, union. Did "
            "you mean \"ball\"?");
  EXPECT_EQ(error_of("[tool]\nspeed = \"1 rpm\"\naxis = [0, 1]\n"),
            "scene.toml:3 tool.axis = [0, 1]: 2 elements. Allowed: 3. Meaning: direction of the axis");
  EXPECT_EQ(
      error_of("[tool]\nspeed = \"1 rpm\"\nposition = [\"1 mm\", 2]\n"),
      "scene.toml:3 tool.position[1] = 2: a number without a unit. Expected: a quantity in m (start of the axis). "
      "If SI is meant, write position = \"2 m\"");
}

TEST(InputErrors, FormulaAndSyntax) {
  const std::string formula = error_of(replaced(good, "sin(2*pi*t)", "sin(2*pi*x)"));
  EXPECT_EQ(
      formula.rfind("scene.toml:7 tool.feed = \"0.1*sin(2*pi*x)\": the formula \"0.1*sin(2*pi*x)\" is wrong at", 0), 0u)
      << formula;
  EXPECT_NE(formula.find("Known names: t, pi;"), std::string::npos) << formula;
  EXPECT_NE(error_of(replaced(good, "0.1*sin(2*pi*t)", "0.1")).find("has no unit"), std::string::npos);
  EXPECT_NE(error_of(replaced(good, "0.1*sin(2*pi*t)", "t = 3")).find("assignment"), std::string::npos);
  const std::string syntax = error_of("[time]\nend = \"2 s\n");
  EXPECT_EQ(syntax.rfind("scene.toml:2: not valid TOML: ", 0), 0u) << syntax;
  EXPECT_EQ(error_of("a = 1\na = 2\n").rfind("scene.toml:2: not valid TOML: ", 0), 0u) << error_of("a = 1\na = 2\n");
  EXPECT_EQ(error_of("[time\n").rfind("scene.toml:1: not valid TOML: ", 0), 0u) << error_of("[time\n");
  EXPECT_THROW(parse_file("/no/such/scene.toml", scene()), InputError);
  EXPECT_THROW(parse_file("/tmp", scene()), InputError);
}

/// Without these limits, deep nesting overran the stack and the name left through an exception of the standard library.
TEST(InputErrors, NestingAndNamesHaveLimits) {
  const auto times = [](const std::string& part, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += part;
    return text;
  };
  for (const std::string& deep :
       {"a = " + times("[", 5000), "a = " + times("[", 5000) + times("]", 5000), "a = " + times("{b = ", 5000),
        "a" + times(".b", 5000) + " = 1", times("[", 5000), "a = " + times("['''\n]''', ", 5000)})
    EXPECT_NE(error_of("[time]\nend = \"1 s\"\n" + deep).find("nested here"), std::string::npos) << deep.substr(0, 20);
  // What only looks nested is not refused for that.
  for (const std::string& flat : {good + "# " + times("{", 300) + "\n", "a = \"" + times("[", 300) + "\\\"\"\n",
                                  "a = '''" + times("[", 300) + "''''\n", "a = [" + times("0.5, ", 300) + "]\n"})
    EXPECT_EQ(error_of(flat).find("nested here"), std::string::npos) << flat.substr(0, 20);
  EXPECT_THROW(parse_file(times("long", 500) + ".toml", scene()), InputError);
}

TEST(Input, CallersCanFailAtAKey) {
  try {
    read(good).tables("body")[1].fail("kernel", "not in this space");
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "scene.toml:17 body[1].kernel = \"wendland_c2\": not in this space");
  }
}

TEST(Input, Overrides) {
  const Parameters p = read(good, {"tool.speed=10 rpm", "body.0.temperature=300 K", "body[1].scaling=7", "title=12",
                                   "time.adaptive=false", "tool.axis=[1,0,0]", "body.1.shape.parts.0.radius=\"3 mm\""});
  EXPECT_NEAR(p.table("tool").real("speed"), std::numbers::pi / 3, 1e-12);
  EXPECT_EQ(p.tables("body")[0].real("temperature"), 300);
  EXPECT_EQ(p.tables("body")[1].real("scaling"), 7);
  EXPECT_EQ(p.text("title"), "12");
  EXPECT_FALSE(p.table("time").boolean("adaptive"));
  EXPECT_EQ(p.table("tool").vector("axis"), (Vec3{1, 0, 0}));
  EXPECT_EQ(p.tables("body")[1].table("shape").tables("parts")[0].real("radius"), 0.003);
  EXPECT_EQ(read("", {"time.end=3 s"}).table("time").real("end"), 3);
  EXPECT_EQ(error_of(good, {"tool.speed=10"}).rfind("command line tool.speed = 10: a number without a unit", 0), 0u)
      << error_of(good, {"tool.speed=10"});
  EXPECT_NE(error_of(good, {"body.2.scaling=7"}).find("no index of body. Allowed: 0 to 1"), std::string::npos);
  EXPECT_NE(error_of(good, {"tool.sped=7 rpm"}).find("Did you mean \"speed\"?"), std::string::npos);
  EXPECT_NE(error_of(good, {"tool.speed.x=7 rpm"}).find("not a table"), std::string::npos);
  EXPECT_NE(error_of(good, {"tool.speed"}).find("Write section.key=value"), std::string::npos);
}

/// The effective input without its comments: the "(default)" marks go when a default has been written out.
std::string without_comments(const std::string& text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = text.find('\n', begin);
    const std::string line = text.substr(begin, end - begin);
    result += line.substr(0, line.find("  # ")) + "\n";
    begin = end + 1;
  }
  return result;
}

TEST(Input, EffectiveInputReadsBack) {
  for (const std::string& text : {good, std::string()}) {
    const Parameters first = read(text);
    const std::string written = first.as_toml();
    const Parameters second = read(written);
    EXPECT_EQ(without_comments(written), without_comments(second.as_toml()));
    EXPECT_EQ(second.table("time").real("end"), first.table("time").real("end"));
    ASSERT_EQ(second.tables("body").size(), first.tables("body").size());
    for (std::size_t i = 0; i < first.tables("body").size(); ++i)
      EXPECT_EQ(second.tables("body")[i].real("temperature"), first.tables("body")[i].real("temperature"));
    if (text.empty()) continue;
    EXPECT_EQ(second.table("tool").real("speed"), first.table("tool").real("speed"));
    EXPECT_EQ(second.tables("body")[1].table("shape").tables("parts")[1].tables("parts")[0].real("radius"), 0.002);
    EXPECT_EQ(second.table("tool").expression("feed")({0.1}), first.table("tool").expression("feed")({0.1}));
    EXPECT_NE(written.find("force = \"12000 N\"  # axial force\n"), std::string::npos) << written;
    EXPECT_NE(written.find("temperature = \"293.15 K\"  # start temperature (default)\n"), std::string::npos);
  }
}

/// Every declared key of a schema, nested ones too.
void visit(const Schema& schema, const std::function<void(const Entry&)>& work, int depth = 0) {
  for (const auto& entry : schema.entries()) {
    work(*entry);
    if (entry->table) visit(*entry->table, work, depth);
    if (entry->alternatives && depth == 0)
      for (const auto& [name, alternative] : entry->alternatives()) visit(alternative, work, depth + 1);
  }
}

TEST(Manual, NamesEveryKeyWithUnitAndMeaning) {
  const Schema schema = scene();
  const std::string text = manual(schema, "Scene");
  EXPECT_EQ(text.rfind("# Scene\n", 0), 0u);
  visit(schema, [&](const Entry& entry) {
    const auto at = text.find("| `" + entry.key + "` | ");
    ASSERT_NE(at, std::string::npos) << entry.key << "\n" << text;
    EXPECT_FALSE(entry.doc.empty()) << entry.key;
    EXPECT_NE(text.find("| " + entry.doc + " |\n", at), std::string::npos) << entry.key;
    if (entry.si_unit != "1") {
      EXPECT_NE(text.find(", " + entry.si_unit + " |", at), std::string::npos) << entry.key;
    }
  });
  EXPECT_NE(text.find("| `end` | quantity, s | 2 s | > 0 s | end time |"), std::string::npos) << text;
  EXPECT_NE(text.find("## [body.shape] type = \"ball\""), std::string::npos) << text;
  EXPECT_NE(text.find("`body.shape.parts`: the same kinds as `body.shape`"), std::string::npos) << text;
}

TEST(Manual, RefusesADeclarationWithoutARealUnit) {
  Schema schema;
  schema.real("force", "a force").unit("newtoon");
  EXPECT_THROW(manual(schema, "Scene"), Error);
}

TEST(Expression, ConstantsAndVariables) {
  EXPECT_NEAR(Expression("2*pi", {})({}), 2 * std::numbers::pi, 1e-15);
  EXPECT_TRUE(Expression("2*pi", {"x"}).is_constant());
  const Expression formula("x^2 + 10*y", {"x", "y"});
  EXPECT_FALSE(formula.is_constant());
  EXPECT_EQ(formula({3, 2}), 29);
  const Expression copy = formula;
  EXPECT_EQ(copy({1, 0}), 1);
  EXPECT_EQ(Expression(4.5)({}), 4.5);
  EXPECT_THROW(Expression("x +", {"x"}), InputError);
  EXPECT_THROW(Expression("1, 2", {}), InputError);
  EXPECT_THROW(Expression("1/0", {}), InputError);
  EXPECT_THROW(Expression("1/x", {"x"})({0}), InputError);
}

}  // namespace
}  // namespace stirsph::input
