// What was probably meant by a name that does not exist.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sutura {

/// What users of other programs write for something that goes by another name here: "timestep" for
/// dt, "TetrahedronFEMForceField" for Tissue. Among `candidates`; empty if the word is not known.
std::string other_word(std::string_view name, std::span<const std::string> candidates);

/// Lower case, without what joins words: "youngModulus", "young_modulus" -> "youngmodulus".
std::string bare(std::string_view name);

}  // namespace sutura
