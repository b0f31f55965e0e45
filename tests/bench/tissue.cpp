// sutura_bench_tissue FOLDER [cure|steps|age|compliance]...: writes the tables of the tissue into
// FOLDER, all of them if none is named.
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "tissue_bench_parts.h"

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: sutura_bench_tissue FOLDER [cure|steps|age|compliance]...\n");
    return 1;
  }
  const std::string folder = argv[1];
  std::filesystem::create_directories(folder);
  const auto asked = [&](const char* part) {
    for (int i = 2; i < argc; ++i)
      if (std::strcmp(argv[i], part) == 0) return true;
    return argc == 2;
  };
  using namespace sutura::bench;
  if (asked("cure")) tissue_cure(folder);
  if (asked("age")) tissue_age(folder);
  if (asked("compliance")) tissue_compliance(folder);
  if (asked("steps")) tissue_steps(folder, true);
  return 0;
}
