#include "host/session.h"

#include <mutex>
#include <shared_mutex>
#include <unordered_map>

namespace sutura::host {
namespace {

struct Sessions {
  std::shared_mutex mutex;
  std::unordered_map<std::uint64_t, std::shared_ptr<Session>> all;
  std::uint64_t next = 1;
  const std::shared_ptr<Cache> cache = std::make_shared<Cache>();
};

/// Never destroyed: a host may still call while the process ends.
Sessions& sessions() {
  static Sessions* const only = new Sessions;
  return *only;
}

}  // namespace

void Session::tell(int severity, const std::string& sentence) const {
  if (message == nullptr) return;
  in_mode_of_host([&] { message(user, severity, sentence.c_str()); });
}

std::uint64_t handle(std::uint64_t session, Kind kind, std::size_t number) {
  return static_cast<std::uint64_t>(kind) << 60 | session << 24 | number;
}

std::shared_ptr<Cache> common_cache() {
  return sessions().cache;
}

std::uint64_t keep(std::shared_ptr<Session> session) {
  const std::unique_lock lock(sessions().mutex);
  const std::uint64_t number = sessions().next++;
  sessions().all.emplace(number, std::move(session));
  return number;
}

std::shared_ptr<Session> find(std::uint64_t session) {
  const std::shared_lock lock(sessions().mutex);
  const auto found = sessions().all.find(session);
  return found == sessions().all.end() ? nullptr : found->second;
}

std::shared_ptr<Session> drop(std::uint64_t session) {
  const std::unique_lock lock(sessions().mutex);
  const auto found = sessions().all.extract(session);
  return found.empty() ? nullptr : found.mapped();
}

}  // namespace sutura::host
