/// The parameter manual: one Markdown table per section, made from the declarations.
#include <limits>
#include <map>

#include "input/node.hpp"
#include "input/units.hpp"
#include "input/wording.hpp"

namespace stirsph::input {
namespace {

class ManualWriter {
 public:
  explicit ManualWriter(const std::string& title) : out_("# " + title + "\n") {}

  void section(const Schema& schema, const std::string& name, const std::string& heading) {
    if (!heading.empty()) out_ += "\n## " + heading + "\n";
    if (!schema.doc.empty()) out_ += "\n" + schema.doc + "\n";
    if (!schema.entries().empty()) {
      out_ += "\n| key | type, unit | default | allowed | meaning |\n|---|---|---|---|---|\n";
      for (const auto& entry : schema.entries()) row(*entry);
    }
    for (const auto& entry : schema.entries()) children(*entry, name.empty() ? entry->key : name + "." + entry->key);
  }

  std::string text() && { return std::move(out_); }

 private:
  static std::string cell(const std::string& text) {
    std::string result;
    for (const char c : text) {
      if (c == '|') result += '\\';
      result += c == '\n' ? ' ' : c;
    }
    return result;
  }

  static std::string type(const Entry& entry) {
    const std::string unit = entry.si_unit == "1" ? "no unit" : entry.si_unit;
    switch (entry.type) {
      case Entry::Type::Real:
        return "quantity, " + unit;
      case Entry::Type::Reals:
        return "list of quantities, " + unit;
      case Entry::Type::Integer:
        return "integer";
      case Entry::Type::Boolean:
        return "true or false";
      case Entry::Type::Text:
        return "text";
      case Entry::Type::Texts:
        return "list of texts";
      case Entry::Type::Choice:
        return "choice";
      case Entry::Type::Expression:
        return "quantity or formula of " + joined(entry.variables) + ", " + unit;
      case Entry::Type::Table:
        return "table";
      case Entry::Type::Tables:
        return "list of tables";
      case Entry::Type::Variant:
        return "table, kind by `" + entry.selector + "`";
      case Entry::Type::Variants:
        return "list of tables, kind by `" + entry.selector + "`";
    }
    return {};
  }

  static std::string standard(const Entry& entry) {
    if (entry.default_value) {
      if (entry.type == Entry::Type::Boolean) return *entry.default_value != 0 ? "true" : "false";
      return shortest(*entry.default_value) + (entry.si_unit == "1" ? "" : " " + entry.si_unit);
    }
    if (entry.default_text) return entry.default_text->empty() ? "\"\"" : *entry.default_text;
    if (!entry.required) return "optional";
    if (entry.type == Entry::Type::Table) return "";
    if ((entry.type == Entry::Type::Tables || entry.type == Entry::Type::Variants) && entry.fewest == 0) return "none";
    return "**required**";
  }

  static std::vector<std::string> alternative_names(const Entry& entry) {
    std::vector<std::string> names;
    for (const auto& item : entry.alternatives()) names.push_back(item.first);
    return names;
  }

  static std::string allowed(const Entry& entry) {
    std::string text = allowed_range(entry);
    if (!entry.choices.empty()) text = joined(entry.choices);
    if (entry.alternatives) text = entry.selector + ": " + joined(alternative_names(entry));
    const bool any_count = entry.most == std::numeric_limits<std::size_t>::max();
    if (entry.fewest > 0 || !any_count) {
      if (!text.empty()) text += "; ";
      text += std::to_string(entry.fewest);
      if (entry.most != entry.fewest) text += any_count ? " or more" : " to " + std::to_string(entry.most);
      text += " elements";
    }
    return text;
  }

  void row(const Entry& entry) {
    check_unit(entry.si_unit);
    out_ += "| `" + entry.key + "` | " + cell(type(entry)) + " | " + cell(standard(entry)) + " | " +
            cell(allowed(entry)) + " | " + cell(entry.doc) + " |\n";
  }

  void children(const Entry& entry, const std::string& name) {
    if (entry.type == Entry::Type::Table) section(*entry.table, name, "[" + name + "]");
    if (entry.type == Entry::Type::Tables) section(*entry.table, name, "[[" + name + "]]");
    if (!entry.alternatives) return;
    const auto& alternatives = entry.alternatives();
    const auto [first, is_new] = described_.emplace(&alternatives, name);
    if (!is_new) {  // shapes hold shapes: describe the kinds once
      if (first->second != name) out_ += "\n`" + name + "`: the same kinds as `" + first->second + "`.\n";
      return;
    }
    for (const auto& [kind, schema] : alternatives) {
      const std::string bracketed = entry.type == Entry::Type::Variant ? "[" + name + "]" : "[[" + name + "]]";
      section(schema, name, bracketed + " " + entry.selector + " = " + in_quotes(kind));
    }
  }

  std::string out_;
  std::map<const void*, std::string> described_;  ///< kinds already described, and where
};

}  // namespace

std::string manual(const Schema& schema, const std::string& title) {
  ManualWriter writer(title);
  writer.section(schema, "", "");
  return std::move(writer).text();
}

}  // namespace stirsph::input
