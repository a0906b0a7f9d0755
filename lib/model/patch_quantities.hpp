// The quantities of contact patches: arrays of contacts.pvd, and fields of the array that
// Simulation.contacts() of the Python module returns. A new one is a line here.
#pragma once

#include <array>

#include "lib/contact/law/contact.hpp"

namespace apothem {

struct PatchQuantity {
  const char* in_frames;  ///< name in contacts.pvd; null: not there
  const char* in_python;  ///< name in Python; null: not there
  bool is_vector;
  Vec2 (*value)(const ContactRecord&);  ///< of a number, the first component counts
};

inline constexpr std::array kPatchQuantities{
    PatchQuantity{
        "force_on_a", nullptr, true,
        [](const ContactRecord& c) -> Vec2 { return c.normal + c.damping + c.tangential; }},
    PatchQuantity{"normal_force_on_a", nullptr, true,
                  [](const ContactRecord& c) -> Vec2 { return c.normal + c.damping; }},
    PatchQuantity{nullptr, "normal", true, [](const ContactRecord& c) { return c.normal; }},
    PatchQuantity{"damping_force_on_a", "damping", true,
                  [](const ContactRecord& c) { return c.damping; }},
    PatchQuantity{"tangential_force_on_a", "tangential", true,
                  [](const ContactRecord& c) { return c.tangential; }},
    PatchQuantity{"penetration", "penetration", false,
                  [](const ContactRecord& c) { return Vec2(c.penetration, 0); }},
    PatchQuantity{"phi", "phi", false, [](const ContactRecord& c) { return Vec2(c.phi, 0); }}};

}  // namespace apothem
