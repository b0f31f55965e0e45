// Counts what the running thread takes from the heap, whoever asks: operator new, Eigen, C. For one
// file of a test program. Absent under sanitizers, which have a heap of their own.
#pragma once

#ifndef SUTURA_SANITIZED
#define SUTURA_COUNTS_ALLOCATIONS

#include <link.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sutura::test {

/// Where the code of some libraries lies in memory.
class LoadedLibraries {
 public:
  /// Those that are loaded now and have one of these words in their name.
  void find(std::vector<std::string> words) {
    words_ = std::move(words);
    count_ = 0;
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void* self) {
          static_cast<LoadedLibraries*>(self)->add(*info);
          return 0;
        },
        this);
  }
  bool contain(const void* code) const {
    const auto at = reinterpret_cast<std::uintptr_t>(code);
    for (std::size_t i = 0; i < count_; ++i)
      if (at >= ranges_[i].begin && at < ranges_[i].end) return true;
    return false;
  }

 private:
  struct Range {
    std::uintptr_t begin, end;
  };
  void add(const dl_phdr_info& info) {
    const std::string_view name = info.dlpi_name;
    for (const std::string& word : words_) {
      if (name.find(word) == name.npos || count_ == ranges_.size()) continue;
      Range& range = ranges_[count_++] = {UINTPTR_MAX, 0};
      for (int i = 0; i < info.dlpi_phnum; ++i) {
        const std::uintptr_t begin = info.dlpi_addr + info.dlpi_phdr[i].p_vaddr;
        if (info.dlpi_phdr[i].p_type != PT_LOAD) continue;
        range.begin = std::min(range.begin, begin);
        range.end = std::max(range.end, begin + info.dlpi_phdr[i].p_memsz);
      }
      return;
    }
  }
  std::vector<std::string> words_;
  std::array<Range, 32> ranges_{};
  std::size_t count_ = 0;
};

/// What these take for themselves does not count.
inline LoadedLibraries& uncounted() {
  static LoadedLibraries libraries;
  return libraries;
}

/// So far, by this thread; what realloc hands back counts too.
inline long& allocations() {
  static constinit thread_local long count = 0;
  return count;
}

inline void count_allocation(const void* caller) {
  static constinit thread_local bool counting = false;  // finding out may itself allocate
  if (counting) return;
  counting = true;
  if (!uncounted().contain(caller)) ++allocations();
  counting = false;
}

}  // namespace sutura::test

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  sutura::test::count_allocation(__builtin_return_address(0));
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  sutura::test::count_allocation(__builtin_return_address(0));
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  sutura::test::count_allocation(__builtin_return_address(0));
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  sutura::test::count_allocation(__builtin_return_address(0));
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  sutura::test::count_allocation(__builtin_return_address(0));
  *out = __libc_memalign(alignment, size);
  return *out != nullptr ? 0 : ENOMEM;
}
}

#endif
