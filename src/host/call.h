// What every function of the C API does first and last: the host's floating-point mode, exceptions,
// the handle, one call at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "base/floating_point.h"
#include "host/session.h"

namespace sutura::host {

inline constexpr sutura_status ok = SUTURA_OK;

/// Notes the sentence for sutura_error and returns the status.
sutura_status fail(sutura_status status, const std::string& sentence) noexcept;

/// One call on one session. Not `ok` if the handle leads nowhere or another call is at work.
class Entry {
 public:
  Entry(std::uint64_t handle, Kind kind, const std::fenv_t& environment);
  ~Entry();
  Entry(const Entry&) = delete;
  Entry& operator=(const Entry&) = delete;

  bool ok() const { return session_ != nullptr; }
  sutura_status status() const { return status_; }
  Session& session() const { return *session_; }

 private:
  std::shared_ptr<Session> session_;
  sutura_status status_ = host::ok;
};

/// Of a function that needs no session.
template <class F>
sutura_status guarded(const F& f) noexcept {
  const FloatingPoint mode;
  try {
    return f(mode.of_host());
  } catch (const std::bad_alloc&) {
    return fail(SUTURA_NO_MEMORY, "there is not enough memory");
  } catch (const std::exception& e) {
    return fail(SUTURA_INTERNAL, std::string("internal error: ") + e.what());
  } catch (...) {
    return fail(SUTURA_INTERNAL, "internal error");
  }
}

/// `f(session, number)` with what the handle names. `result`: where the function writes.
template <class F>
sutura_status with(std::uint64_t handle, Kind kind, const void* result, const F& f) noexcept {
  return guarded([&](const std::fenv_t& environment) -> sutura_status {
    const Entry entry(handle, kind, environment);
    if (!entry.ok()) return entry.status();
    if (result == nullptr) return fail(SUTURA_MISUSE, "a pointer is null");
    return f(entry.session(), number_of(handle));
  });
}

/// Size of a struct as it was in the first release: a program compiled then has no more room. Where
/// one has grown since, its size of then is to be written here.
template <class Struct>
inline constexpr std::size_t first_size = sizeof(Struct);
template <>
inline constexpr std::size_t first_size<sutura_options> = offsetof(sutura_options, enqueue);

/// Fills a struct of the API that begins with its size, as far as the caller knows it.
template <class Struct>
sutura_status fill(Struct* out, Struct value) {
  const std::uint32_t size = out->struct_size;
  if (size < first_size<Struct>)
    return fail(SUTURA_MISUSE, "struct_size is " + std::to_string(size) +
                                   "; expected the size of the struct, " +
                                   std::to_string(sizeof(Struct)));
  value.struct_size = size;
  std::memcpy(out, &value, std::min<std::size_t>(size, sizeof value));
  return ok;
}

/// A sentence about the number of something of which there are `count`.
inline std::string no_such(const char* what, std::size_t number, std::size_t count) {
  return "there is no " + std::string(what) + " " + std::to_string(number) + "; there are " +
         std::to_string(count) + ", counted from 0";
}

}  // namespace sutura::host
