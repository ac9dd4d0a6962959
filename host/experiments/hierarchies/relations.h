#pragma once
// What the thesis's chapter 4 says about its hierarchies in numbers, and whether it holds here.
#include <string>
#include <vector>

#include "host/experiments/hierarchies/hierarchies_page.h"

namespace rayfarm {

/// A statement of the thesis about numbers, ours beside it, and what was measured where they differ.
struct Relation {
  std::string what, thesis, here;
  bool holds = false;
  std::string why{};  ///< shown where it does not hold
};

/// Those of storage and traversal, then those of construction and of profiles.
std::vector<Relation> make_relations(const HierarchyStudy& study);
std::vector<Relation> construction_relations(const HierarchyStudy& study);
std::vector<Relation> profile_relations(const HierarchyStudy& study);

/// The relations in Markdown, and below the table the reasons for what does not hold.
std::string relations_text(const std::vector<Relation>& relations);

}  // namespace rayfarm
