// What was probably meant by a name that does not exist.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sutura {

/// What users of other programs write for something that goes by another name here: "timestep" for
/// dt, "TetrahedronFEMForceField" for Tissue. Among `candidates`; empty if the word is not known.
std::string other_word(std::string_view name, std::span<const std::string> candidates);

/// What does here what a component of another program is for, a sentence, where that is no
/// component of ours: "BarycentricMapping". Empty if the name is not known.
std::string what_instead(std::string_view name);

/// Lower case, without what joins words: "youngModulus", "young_modulus" -> "youngmodulus".
std::string bare(std::string_view name);

}  // namespace sutura
