#include "host/call.h"

namespace sutura::host {
namespace {

thread_local std::string last_error;
thread_local bool error_lost = false;

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::simulation:
      return "a simulation";
    case Kind::input:
      return "an input";
    case Kind::output:
      return "an output";
    case Kind::body:
      return "a body";
    case Kind::tool:
      return "a tool";
  }
  return "no handle";
}

std::size_t count_of(const Session& session, Kind kind) {
  switch (kind) {
    case Kind::simulation:
      return 1;
    case Kind::input:
      return session.inputs.size();
    case Kind::output:
      return session.outputs.size();
    case Kind::body:
      return session.shapes.size();
    case Kind::tool:
      return session.tools.size();
  }
  return 0;
}

}  // namespace

sutura_status fail(sutura_status status, const std::string& sentence) noexcept {
  try {
    last_error = sentence;
    error_lost = false;
  } catch (...) {
    error_lost = true;
  }
  return status;
}

Entry::Entry(std::uint64_t handle, Kind kind, const std::fenv_t& environment) {
  const auto found = static_cast<Kind>(handle >> 60);
  std::shared_ptr<Session> session = found == kind ? find(session_of(handle)) : nullptr;
  if (handle == 0)
    status_ = fail(SUTURA_MISUSE, std::string("expected ") + name_of(kind) + ", not 0");
  else if (found != kind)
    status_ = fail(SUTURA_MISUSE, std::string("expected the handle of ") + name_of(kind) +
                                      "; this one is that of " + name_of(found));
  else if (!session)
    status_ = fail(SUTURA_MISUSE,
                   "the simulation of this handle has been destroyed, or there never was one");
  else if (number_of(handle) >= count_of(*session, kind))
    status_ = fail(SUTURA_MISUSE, std::string("this is not the handle of ") + name_of(kind));
  else if (session->busy.exchange(true, std::memory_order_acquire))
    status_ = fail(SUTURA_BUSY, "another call on this simulation has not returned yet");
  else
    session_ = std::move(session);
  if (session_) session_->environment = &environment;
}

Entry::~Entry() {
  if (session_) session_->busy.store(false, std::memory_order_release);
}

}  // namespace sutura::host

using namespace sutura::host;

uint32_t sutura_api(void) {
  return SUTURA_API;
}

const char* sutura_version(void) {
  return SUTURA_VERSION;
}

const char* sutura_error(void) {
  return error_lost ? "there is not enough memory" : last_error.c_str();
}
