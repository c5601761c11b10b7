/// Every example of inputs/README.md, and every scene in inputs/, starts and makes steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "driver/probes.hpp"
#include "driver/scene_check.hpp"
#include "driver/simulation.hpp"
#include "scene/scene.hpp"

namespace stirsph {
namespace {

const std::string folder = std::string(STIRSPH_SOURCE_DIR) + "/inputs";

/// A table with its header line; the header is empty for the keys before the first table.
struct Section {
  std::string header, text;
};

std::vector<Section> sections_of(const std::string& text) {
  std::vector<Section> sections{{}};
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind('[', 0) == 0) sections.push_back({line.substr(0, line.find_last_of(']') + 1), ""});
    sections.back().text += line + "\n";
  }
  return sections;
}

/// The TOML blocks of a Markdown file.
std::vector<std::string> toml_blocks(const std::string& path) {
  std::vector<std::string> blocks;
  std::ifstream file(path);
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("```", 0) == 0) {
      inside = line == "```toml";
      if (inside) blocks.emplace_back();
    } else if (inside) {
      blocks.back() += line + "\n";
    }
  }
  return blocks;
}

/// The head of the README with an example: tables of the example take the place of those of the head.
std::string completed(const std::string& head, const std::string& example) {
  std::string first, rest;
  const std::vector<Section> own = sections_of(example);
  for (const Section& section : sections_of(head)) {
    const bool replaced = !section.header.empty() && std::any_of(own.begin(), own.end(), [&](const Section& s) {
      return s.header == section.header;
    });
    if (!replaced) (section.header.empty() ? first : rest) += section.text;
  }
  for (const Section& section : own) (section.header.empty() ? first : rest) += section.text;
  return first + rest;
}

TEST(Inputs, ReadmeExamplesRun) {
  const std::vector<std::string> blocks = toml_blocks(folder + "/README.md");
  ASSERT_GE(blocks.size(), 15u);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const std::string text = k == 0 ? blocks[0] : completed(blocks[0], blocks[k]);
    try {
      Simulation simulation(Comm(), read_scene_text(text, folder));
      check_field_names(simulation);
      simulation.start();
      for (int step = 0; step < 3; ++step) simulation.step();
    } catch (const Error& error) {
      ADD_FAILURE() << "example " << k << " of inputs/README.md: " << error.what() << "\n" << text;
    }
  }
}

TEST(Inputs, ScenesPassTheCheck) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().filename() != "scene.toml" && entry.path().filename() != "displacement.toml") continue;
    ++scenes;
    try {
      const std::string report = check_scene(Comm(), read_scene(entry.path().string()));
      EXPECT_NE(report.find("predicted wall time"), std::string::npos);
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
  }
  EXPECT_GE(scenes, 10);
}

}  // namespace
}  // namespace stirsph
