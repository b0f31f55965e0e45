// The way from one guess of a rod's step to the next.
//
// Straight on, a beam that turns or bends would be stretched in second order, and that times EA
// hides everything else. So chords turn, and get the length at which the beam has the strain that
// the linear answer says. Where the rod is held or pushed it goes straight on; what does not fit
// between two such places is shared out by the stretch that one force would give the beams there.
#pragma once

#include <vector>

#include "rod_guess.h"

namespace sutura::thread {

/// Largest turn of a chord or a tangent in that motion (rad). What is cut has no chord.
Real largest_turn(const Rod& rod, Configuration c, const Dofs& motion);

class RodWay {
 public:
  void resize(Index nodes);
  void reserve(Index nodes);

  /// From the present guess, by `answer`: a further shift and spin of every node (m, rad; 6 per
  /// node).
  void aim(const Rod& rod, const RodGuess& guess, const Dofs& answer);
  /// The guess becomes the one after `part` of the way.
  void go(Rod& rod, const RodStart& start, RodGuess& guess, Real part);
  /// Tension of the guess after `part` of the way: the linear prediction, which is free of the
  /// stretch that a finite turn fakes.
  void predict_tension(const Rod& rod, RodGuess& guess, Real part) const;

 private:
  void join(const Rod& rod, const RodGuess& guess, Real part);
  Vec3 turned_chord(const Rod& rod, Index e, const Quat& first, const Quat& second,
                    const Vec3& change, Real part) const;
  bool share_out_drift(const Rod& rod, const RodGuess& guess);
  void keep_momentum(Rod& rod, const RodStart& start, RodGuess& guess) const;

  DofVector from_, direction_;  ///< motion of the guess, and its change
  std::vector<Vec3> chord_;     ///< per beam, m
  std::vector<Real> strain_, strain_change_;
  std::vector<Real> give_;   ///< per node: how far a newton stretches the rod up to it, m/N
  std::vector<Vec3> drift_;  ///< per node: off the straight way, m
};

}  // namespace sutura::thread
