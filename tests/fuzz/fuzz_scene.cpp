/// libFuzzer over the scene reader: any text either becomes a scene or is refused with an InputError, and the effective
/// input of a scene reads back to the same effective input. No particle is created and no mesh is made.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/error.hpp"
#include "scene/scene.hpp"

namespace {

/// The comment "(default)" is the one thing that a second reading rightly loses.
std::string without_default_marks(std::string text) {
  const std::string mark = " (default)\n";
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos;) text.erase(at, mark.size() - 1);
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stirsph;
  // A folder from which the material files of the seeds are found.
  const std::string folder = std::string(STIRSPH_SOURCE_DIR) + "/inputs/demo_tube";
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::string effective, again;
  try {
    effective = read_scene_text(text, folder).effective_input;
  } catch (const InputError&) {  // all other exceptions are bugs, and end the fuzzer
    return 0;
  }
  try {
    again = read_scene_text(effective, folder).effective_input;
  } catch (const InputError& wrong) {
    std::fprintf(stderr, "the effective input does not read back: %s\n%s", wrong.what(), effective.c_str());
    std::abort();
  }
  if (without_default_marks(again) != without_default_marks(effective)) {
    std::fprintf(stderr, "the effective input reads back as another one:\n%s\n----\n%s", effective.c_str(),
                 again.c_str());
    std::abort();
  }
  return 0;
}
