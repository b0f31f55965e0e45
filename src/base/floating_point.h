// The floating-point mode in which everything is computed, whatever that of the host is.
#pragma once

#include <cfenv>

namespace sutura {

/// While it lives: rounding to nearest, no traps, no flushing of small numbers. The host's own mode
/// comes back at the end, its flags as they were. Of the calling worker only; one that is started
/// meanwhile begins in this mode.
class FloatingPoint {
 public:
  FloatingPoint() {
    std::fegetenv(&host_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatingPoint() { std::fesetenv(&host_); }
  FloatingPoint(const FloatingPoint&) = delete;
  FloatingPoint& operator=(const FloatingPoint&) = delete;
  const std::fenv_t& of_host() const { return host_; }

 private:
  std::fenv_t host_;
};

}  // namespace sutura
