// What the C API keeps of one simulation, and how a handle leads to it.
#pragma once

#include <atomic>
#include <cfenv>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sutura/cache.h"
#include "sutura/simulation.h"
#include "sutura/sutura.h"
#include "sutura/tool.h"

namespace sutura::host {

struct Input {
  Component* component = nullptr;
  const InputInfo* info = nullptr;
};

struct Output {
  OutputHandle handle;
  std::uint32_t size = 0;  ///< numbers; 0: a text
};

struct Shape {
  std::string path;
  const Body* body = nullptr;
  BodyGeometry geometry;
  std::uint64_t topology = 0;  ///< of `geometry`; 0: there is none yet
  std::uint64_t changes = 0;   ///< of the session, when `geometry` was made
};

struct NamedTool {
  std::string path;
  Tool* tool = nullptr;
};

struct Session {
  Registry registry;  // before the simulation, whose components are described in it
  std::unique_ptr<Simulation> simulation;
  sutura_message message = nullptr;
  void* user = nullptr;

  std::vector<Component*> components;
  std::vector<Input> inputs;
  std::vector<Output> outputs;
  std::vector<Shape> shapes;
  std::vector<NamedTool> tools;

  std::vector<std::byte> initial;  ///< state before the first step
  std::vector<std::byte> saved;    ///< by the last sutura_save
  std::string xml, text;           ///< that the host has been given
  std::uint64_t changes = 1;       ///< of the state
  std::int64_t missed = 0;         ///< steps that are not to be trusted, since the state was given
  bool recording = false;

  std::atomic<bool> busy{false};
  const std::fenv_t* environment = nullptr;  ///< of the host, during a call

  /// Calls the host as it has called.
  template <class Call>
  void in_mode_of_host(const Call& call) const {
    std::fenv_t ours;
    std::fegetenv(&ours);
    if (environment != nullptr) std::fesetenv(environment);
    call();
    std::fesetenv(&ours);
  }
  /// Hands a sentence to the host.
  void tell(int severity, const std::string& sentence) const;
};

enum class Kind : std::uint64_t { simulation = 1, input, output, body, tool };

/// Names something of a session: never 0, never the same for two sessions.
std::uint64_t handle(std::uint64_t session, Kind kind, std::size_t number = 0);
inline std::uint64_t session_of(std::uint64_t handle) {
  return handle >> 24 & 0xfffffffff;
}
inline std::size_t number_of(std::uint64_t handle) {
  return handle & 0xffffff;
}

/// What every session is given, whatever its options: a cache that all of them share.
std::shared_ptr<Cache> common_cache();

/// All sessions of the process. Workers may call at any time.
std::uint64_t keep(std::shared_ptr<Session> session);
std::shared_ptr<Session> find(std::uint64_t session);
/// Nothing if somebody else was quicker.
std::shared_ptr<Session> drop(std::uint64_t session);

}  // namespace sutura::host
