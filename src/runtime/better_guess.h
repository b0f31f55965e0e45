// Where the next pass of a step begins.
//
// A pass takes the guess x to G(x): it linearises each body and its rows. What it leaves out (rows
// that turn with what they touch change their force) makes passes contract slowly, or swing to and
// fro for ever. Anderson's method (D. G. Anderson, J. ACM 12, 1965; H. F. Walker and
// P. Ni, SIAM J. Numer. Anal. 49, 2011) finds that part from the passes themselves: of the last
// few it takes the affine combination whose change G(x) - x is smallest, and the next pass starts
// there. What a step ends with is always the result of a pass, measured like any other. A pass in
// which a body went only part of its way is not G: with it, all before are forgotten.
//
// The change is smallest at any balance, also at one from which passes lead away: a saddle of the
// step's potential, where a thread would stand on edge. So passes between which the potential
// curves down are left out, as methods of the BFGS kind leave out such pairs. Where that leaves
// none, and the last two passes went the same way, they lead away from such a balance, by a little
// more each time: the next one begins as far ahead again as the last one went.
#pragma once

#include <array>
#include <vector>

#include "sutura/simulation.h"

namespace sutura {

class BetterGuess {
 public:
  using Bodies = std::vector<Simulation::NamedBody>;
  /// Makes room for their motions, so that nothing is allocated in a step.
  explicit BetterGuess(const Bodies& bodies);
  /// The passes to come have nothing to do with those before: a new step, or an event.
  void forget();
  /// Before a pass. `rests`: per body, the pass leaves it where it is. One that has rested and had
  /// to move again rests no more: nothing is learnt from passes with and without it that take
  /// turns.
  void begin_pass(std::vector<char>& rests);
  /// After a pass that was not enough. True if passes contract slowly: then the bodies that took
  /// part in it have been moved on to a better guess.
  bool move_on(const StepContext& context);

 private:
  static constexpr std::size_t memory = 5;  ///< passes that are remembered
  struct Pass {
    std::vector<VecX> from, to;  ///< motion of every body before and after (m, rad)
    std::vector<char> rests;
  };
  Real product(const Pass& a, const Pass& b) const;
  bool curve_down(const Pass& a, const Pass& b) const;
  /// Away from a saddle. False if the last two passes went different ways.
  bool go_ahead(const StepContext& context);

  const Bodies& bodies_;
  std::array<Pass, memory> passes_;  ///< the newest first
  std::size_t known_ = 0;
  std::vector<char> woken_;  ///< per body: has rested since `forget`, and had to move again
  bool slow_ = false;        ///< since `forget`
  std::vector<VecX> guess_;  ///< per body
};

}  // namespace sutura
